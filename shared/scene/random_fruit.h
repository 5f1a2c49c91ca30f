#pragma once

#include <cstdint>

#include "scene/fruit_truth.h"
#include "scene/point_cloud.h"

namespace drupe {

struct RandomFruit {
  PointCloud cloud;  ///< of the fruit, its needle and the board; mm, board frame
  FruitTruth truth;
};

struct RandomFruitOptions {
  double spacing_mm = 0.085;     ///< of the points, as a 1080p turntable set gives
  double touching_share = 0.25;  ///< of the fruits that have two defects which touch
  double intact_share = 0.15;    ///< of the fruits without any defect
};

/// A fruit nobody has tuned for, as the dense stage would hand it over: an uneven ellipsoid with a stalk's hollow and a
/// suture; green, yellow, red, purple, brown, dark, grey or pale, mottled, blushed and freckled; rain spots (brown,
/// pale, dark, or only of another hue), scars, cracks and decay of random size, outline and colour; seen from above the
/// board only, by views whose patches differ in light and leave seams and gaps; correlated and single errors of place
/// and colour, leftovers of gloss, the tint of a neighbour. Kinds, sizes and errors follow what rendered sets give
/// (colour noise 1 to 3 Lab units, errors of place of 0.01 to 0.03 mm over 2 mm, gaps of up to 2 mm). The same seed
/// gives the same fruit.
RandomFruit MakeRandomFruit(std::uint64_t seed, const RandomFruitOptions& options = {});

}  // namespace drupe
