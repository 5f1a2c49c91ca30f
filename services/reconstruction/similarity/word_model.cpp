#include "reconstruction/similarity/word_model.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

#include "base/digest.h"
#include "reconstruction/similarity/vocabulary.h"

namespace drupe {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian, and so is memory");

constexpr std::string_view kMagic = "DRPVOCB1";
constexpr std::size_t kHeadBytes = kMagic.size() + 2 * sizeof(std::uint32_t);
constexpr std::size_t kDigestBytes = 64;
constexpr std::uint32_t kMaxGaussians = 1024;  ///< as SimilarityOptions::gaussians

/// D and K.
struct WordSizes {
  std::uint32_t dimensions = 0;
  std::uint32_t gaussians = 0;

  std::size_t FloatCount() const {
    return Features::kDimension * (1 + std::size_t{dimensions}) + gaussians * (1 + 2 * std::size_t{dimensions});
  }
  std::size_t FileBytes() const { return kHeadBytes + sizeof(float) * FloatCount() + kDigestBytes; }
};

Status Bad(const std::string& what) {
  return Unprocessable("bad_vocabulary", "the vocabulary cannot be read: " + what);
}

/// Descriptors drawn evenly from these pictures, about `wanted` in all.
SampleMatrix TrainingSet(std::span<const Features> features, const SimilarityOptions& options) {
  std::size_t total = 0;
  for (const Features& picture : features) {
    total += std::min<std::size_t>(picture.size(), options.descriptors_per_image);
  }
  const std::size_t stride = std::max<std::size_t>(1, total / options.training_descriptors);
  std::vector<SampleMatrix> parts;
  Eigen::Index columns = 0;
  for (const Features& picture : features) {
    parts.push_back(DescriptorSamples(picture, options.descriptors_per_image, stride));
    columns += parts.back().cols();
  }
  SampleMatrix all(Features::kDimension, columns);
  Eigen::Index at = 0;
  for (const SampleMatrix& part : parts) {
    all.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return all;
}

template <typename Matrix>
void AppendFloats(const Matrix& matrix, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(matrix.data()), sizeof(float) * static_cast<std::size_t>(matrix.size()));
}

/// Fills `matrix`, which has its size, from the front of `bytes`, and takes that off.
template <typename Matrix>
void TakeFloats(std::string_view& bytes, Matrix& matrix) {
  const std::size_t length = sizeof(float) * static_cast<std::size_t>(matrix.size());
  std::memcpy(matrix.data(), bytes.data(), length);
  bytes.remove_prefix(length);
}

Result<WordSizes> CheckedSizes(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return Bad("not a vocabulary of this version");
  if (bytes.size() < kHeadBytes + kDigestBytes) return Bad("cut off");
  WordSizes sizes;
  std::memcpy(&sizes.dimensions, bytes.data() + kMagic.size(), sizeof(std::uint32_t));
  std::memcpy(&sizes.gaussians, bytes.data() + kMagic.size() + sizeof(std::uint32_t), sizeof(std::uint32_t));
  const bool fits = sizes.dimensions >= 1 && sizes.dimensions <= Features::kDimension && sizes.gaussians >= 1 &&
                    sizes.gaussians <= kMaxGaussians;
  if (!fits || bytes.size() != sizes.FileBytes()) return Bad("the length is wrong");
  const std::string_view content = bytes.substr(0, bytes.size() - kDigestBytes);
  if (Sha256Hex(content) != bytes.substr(content.size())) return Bad("damaged");
  return sizes;
}

Status CheckNumbers(const WordModel& model) {
  const bool finite = model.pca.mean.allFinite() && model.pca.basis.allFinite() && model.mixture.weights.allFinite() &&
                      model.mixture.means.allFinite() && model.mixture.variances.allFinite();
  if (!finite) return Bad("a number is not finite");
  if (model.mixture.weights.minCoeff() <= 0) return Bad("a weight is not positive");
  return model.mixture.variances.minCoeff() > 0 ? Status::Ok() : Bad("a variance is not positive");
}

}  // namespace

SampleMatrix DescriptorSamples(const Features& picture, std::size_t limit, std::size_t stride) {
  constexpr float kNorm = 512;  // see Features
  const std::size_t available = std::min(picture.size(), limit);
  const auto count = static_cast<Eigen::Index>((available + stride - 1) / stride);
  SampleMatrix samples(Features::kDimension, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::uint8_t* descriptor = picture.Descriptor(static_cast<std::size_t>(i) * stride);
    for (int k = 0; k < Features::kDimension; ++k) samples(k, i) = static_cast<float>(descriptor[k]) / kNorm;
  }
  return samples;
}

Result<WordModel> TrainWords(std::span<const Features> features, const SimilarityOptions& options,
                             const RunContext& context) {
  const SampleMatrix training = TrainingSet(features, options);
  if (training.cols() == 0) {
    return Unprocessable("no_features", "none of the pictures has a feature; are they sharp and lit?");
  }
  WordModel model;
  model.pca = FitPca(training, options.pca_dimensions);
  const int gaussians = static_cast<int>(std::min<Eigen::Index>(options.gaussians, training.cols()));
  DRUPE_ASSIGN_OR_RETURN(model.mixture,
                         FitGaussianMixture(model.pca.Reduce(training), gaussians, options.em_iterations, context));
  return model;
}

std::string WriteWords(const WordModel& model) {
  const WordSizes sizes{static_cast<std::uint32_t>(model.pca.basis.cols()),
                        static_cast<std::uint32_t>(model.mixture.size())};
  std::string bytes(kMagic);
  bytes.append(reinterpret_cast<const char*>(&sizes.dimensions), sizeof(std::uint32_t));
  bytes.append(reinterpret_cast<const char*>(&sizes.gaussians), sizeof(std::uint32_t));
  AppendFloats(model.pca.mean, bytes);
  AppendFloats(model.pca.basis, bytes);
  AppendFloats(model.mixture.weights, bytes);
  AppendFloats(model.mixture.means, bytes);
  AppendFloats(model.mixture.variances, bytes);
  return bytes + Sha256Hex(bytes);
}

Result<WordModel> ReadWords(std::string_view bytes) {
  DRUPE_ASSIGN_OR_RETURN(const WordSizes sizes, CheckedSizes(bytes));
  WordModel model;
  model.pca.mean.resize(Features::kDimension);
  model.pca.basis.resize(Features::kDimension, sizes.dimensions);
  model.mixture.weights.resize(sizes.gaussians);
  model.mixture.means.resize(sizes.dimensions, sizes.gaussians);
  model.mixture.variances.resize(sizes.dimensions, sizes.gaussians);
  std::string_view rest = bytes.substr(kHeadBytes);
  TakeFloats(rest, model.pca.mean);
  TakeFloats(rest, model.pca.basis);
  TakeFloats(rest, model.mixture.weights);
  TakeFloats(rest, model.mixture.means);
  TakeFloats(rest, model.mixture.variances);
  DRUPE_RETURN_IF_ERROR(CheckNumbers(model));
  return model;
}

Result<std::string> TrainVocabulary(std::span<const Features> features, const SimilarityOptions& options,
                                    const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_ASSIGN_OR_RETURN(const WordModel model, TrainWords(features, options, context));
  return WriteWords(model);
}

std::size_t MaxDescriptionLength() {
  return std::size_t{kMaxGaussians} * (1 + 2 * std::size_t{Features::kDimension});
}

std::size_t MaxVocabularyBytes() {
  return WordSizes{Features::kDimension, kMaxGaussians}.FileBytes();
}

}  // namespace drupe
