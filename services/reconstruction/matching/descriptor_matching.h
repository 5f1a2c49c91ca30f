#pragma once

#include <vector>

#include "reconstruction/matching/prepared_picture.h"
#include "scene/view_graph.h"

namespace drupe {

/// Matches the packed features of two pictures, all with all: the nearest descriptor, if its distance is less than
/// `max_ratio` times that of the runner-up (Lowe 2004, section 7.1; the paper's H) and the way back gives the same. The
/// result names places in `kept`, ascending by `first`. A pair whose coarsest features hardly match is given up early
/// (Wu 2013, preemptive matching).
std::vector<FeatureMatch> MatchDescriptors(const PreparedPicture& first, const PreparedPicture& second,
                                           double max_ratio);

}  // namespace drupe
