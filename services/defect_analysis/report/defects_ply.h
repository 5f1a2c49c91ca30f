#pragma once

#include <string>

#include "image/colour.h"
#include "scene/point_cloud.h"
#include "scene/report.h"

namespace drupe {

/// The content of defects.ply: the points of the fruits' skin, healthy ones in grey as bright as they are, those of a
/// defect in the colour of its class (rain spot blue, scar yellow, crack red, decay purple), and each contour as white
/// points. Same unit and frame as the cloud; points farther from every fruit's centre than 0.7 of its larger diameter
/// are left out. Without a metric scale the same, in the model's unit.
std::string DefectsPly(const PointCloud& cloud, const std::vector<Fruit>& fruits);

/// sRGB of a class in pictures and clouds.
Rgb8 ClassColour(DefectClass defect_class);

}  // namespace drupe
