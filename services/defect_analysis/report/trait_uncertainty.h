#pragma once

#include "scene/fruit_cloud.h"
#include "scene/report.h"

namespace drupe {

/// Adds to a fruit's traits their standard uncertainties and the spread of its colour. Three causes: the errors of the
/// points, which neighbours share, so that averaging does not remove them (a fifth of their scatter about the surface,
/// but at least 0.0002 of a length, is taken for the error of a radius as a whole); the scale, relative standard
/// uncertainty `scale_sigma`, counted twice in areas and three times in volumes; and what no picture shows, which was
/// closed by a mirror image: 1.5 % of it in volume, 0.8 % in area, 3 % of the polar diameter. `fruit` comes from
/// MeasureTraits of `cloud`.
void AddTraitUncertainties(const FruitCloud& cloud, double scale_sigma, Fruit& fruit);

}  // namespace drupe
