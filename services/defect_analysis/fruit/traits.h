#pragma once

#include "scene/fruit_cloud.h"
#include "scene/report.h"

namespace drupe {

/// The traits of a fruit: centre, volume, surface area, diameters, sphericity, mean colour, observed share. Volume and
/// area are those of the closed surface, the unseen underside included; the volume has the relief of the seen skin too,
/// which is finer than that surface. Polar diameter: the extent along `up`;
/// equatorial diameter: the mean extent over all directions across it. Sphericity: the area of the sphere of the same
/// volume over the fruit's area (Wadell 1935). Lengths in mm, whatever FruitCloud::mm_per_unit is.
Fruit MeasureTraits(const FruitCloud& cloud);

}  // namespace drupe
