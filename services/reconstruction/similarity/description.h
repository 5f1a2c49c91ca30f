#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "reconstruction/similarity/similarity.h"
#include "reconstruction/similarity/word_model.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

/// How a picture looks in given words: the Fisher vector of its coarsest features, of length K (1 + 2 D) and norm 1;
/// all zero for a picture without features.
using Description = Eigen::VectorXf;

/// Of the options, descriptors_per_image alone counts.
Description DescribePicture(const Features& picture, const WordModel& words, const SimilarityOptions& options);

/// As bytes, little-endian: "DRPDESC1", the length (uint32), so many float32; and back, bit by bit. Errors of the way
/// back: 422 `bad_description` (another format or version, cut off, longer than words allow, numbers that are not
/// finite).
std::string WriteDescription(const Description& description);
Result<Description> ReadDescription(std::string_view bytes);

/// The distance of two descriptions in the same words: 0 to 2, and 2 where one of the pictures has no features.
float DescriptionDistance(const Description& a, const Description& b);

/// The graph that RunSimilarity gives of the pictures described.
SimilarityGraph LinkDescriptions(std::span<const Description> descriptions);

/// The `count` of `others` that are most like `picture`, by their index, the most similar first; fewer where there are
/// fewer. Those without features are never among them.
std::vector<std::size_t> MostAlike(const Description& picture, std::span<const Description> others, std::size_t count);

}  // namespace drupe
