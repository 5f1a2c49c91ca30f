#include "reconstruction/similarity/description.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "reconstruction/similarity/fisher_vector.h"

namespace drupe {
namespace {

constexpr std::string_view kDescriptionMagic = "DRPDESC1";
constexpr std::size_t kDescriptionHeadBytes = kDescriptionMagic.size() + sizeof(std::uint32_t);
/// Unit vectors can be no farther from one another.
constexpr float kUnlike = 2;

Status BadDescription(const std::string& what) {
  return Unprocessable("bad_description", "the description of a picture cannot be read: " + what);
}

}  // namespace

Description DescribePicture(const Features& picture, const WordModel& words, const SimilarityOptions& options) {
  const SampleMatrix samples =
      DescriptorSamples(picture, static_cast<std::size_t>(options.descriptors_per_image), /*stride=*/1);
  return FisherVector(words.pca.Reduce(samples), words.mixture);
}

std::string WriteDescription(const Description& description) {
  const auto length = static_cast<std::uint32_t>(description.size());
  std::string bytes(kDescriptionMagic);
  bytes.append(reinterpret_cast<const char*>(&length), sizeof(length));
  return bytes.append(reinterpret_cast<const char*>(description.data()), sizeof(float) * length);
}

Result<Description> ReadDescription(std::string_view bytes) {
  if (!bytes.starts_with(kDescriptionMagic)) return BadDescription("not a description of this version");
  if (bytes.size() < kDescriptionHeadBytes) return BadDescription("cut off");
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + kDescriptionMagic.size(), sizeof(length));
  if (length > MaxDescriptionLength() || bytes.size() != kDescriptionHeadBytes + sizeof(float) * length) {
    return BadDescription("the length is wrong");
  }
  Description description(length);
  std::memcpy(description.data(), bytes.data() + kDescriptionHeadBytes, sizeof(float) * length);
  if (!description.allFinite()) return BadDescription("a number is not finite");
  return description;
}

float DescriptionDistance(const Description& a, const Description& b) {
  const bool comparable = a.size() == b.size() && a.squaredNorm() > 0 && b.squaredNorm() > 0;
  return comparable ? (a - b).norm() : kUnlike;
}

SimilarityGraph LinkDescriptions(std::span<const Description> descriptions) {
  SimilarityGraph graph = UndecidedGraph(descriptions.size());
  const std::size_t n = descriptions.size();
  float extreme = 0;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < n; ++b) {
      if (a == b) continue;
      graph.fisher_distance[a * n + b] = DescriptionDistance(descriptions[a], descriptions[b]);
      extreme = std::max(extreme, graph.fisher_distance[a * n + b]);
    }
  }
  for (std::size_t i = 0; i < n * n; ++i) graph.weight[i] = extreme - graph.fisher_distance[i];
  return graph;
}

std::vector<std::size_t> MostAlike(const Description& picture, std::span<const Description> others, std::size_t count) {
  std::vector<std::pair<float, std::size_t>> ranked;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const float distance = DescriptionDistance(picture, others[i]);
    if (distance < kUnlike) ranked.emplace_back(distance, i);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> most;
  for (std::size_t k = 0; k < std::min(count, ranked.size()); ++k) most.push_back(ranked[k].second);
  return most;
}

}  // namespace drupe
