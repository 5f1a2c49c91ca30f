#include "defect_analysis/defects/significance.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "defect_analysis/defects/sharp_rim.h"
#include "defect_analysis/defects/stain_edge.h"
#include "image/colour.h"

namespace drupe {
namespace {

constexpr double kGrey = 0.1;       // of the mean: channels that differ less do not tell gloss from a change of pigment
constexpr double kMostLit = 1.5;    // times the skin beside a spot: within it, light changes more at a shadow only
constexpr double kOwnLight = 0.08;  // by which gloss leaves the gain of the skin's own light at 1
constexpr double kTint = 0.5;  // of significance_delta_e: lamps are not so coloured that their gloss differs by more
constexpr double kSharpTint = 0.25;  // the same where the border is sharper than gloss is wont to have
// mm over which the level would fall from 1 to 0: what borders gloss is the lamp's edge, blurred by the skin's own
// roughness, some hundredths of a radian times half the fruit's radius at least.
constexpr double kSharpestGloss = 0.2;

/// colour = gain * skin + gloss, by least squares over the channels.
struct LightFit {
  double gain = 0;   ///< how much of the skin's own light the colour has
  double gloss = 0;  ///< added to all channels alike
};

LightFit FitLight(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin) {
  const Eigen::Array3d skin_dev = skin.array() - skin.mean();
  const double gain = (skin_dev * colour.array()).sum() / std::max(1e-9, skin_dev.square().sum());
  return {gain, colour.mean() - gain * skin.mean()};
}

// The colour without the light that it has more than the skin.
Eigen::Vector3d WithoutAddedLight(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin) {
  const auto [gain, gloss] = FitLight(colour, skin);
  if (gain > 1 && gloss > 0) return (colour.array() - gloss) / gain;
  if (gain > 1) return colour / std::max(1.0, colour.dot(skin) / skin.squaredNorm());
  return colour.array() - std::max(0.0, (colour - skin).minCoeff());
}

// The same if the skin is better lit there by kMostLit at most.
Eigen::Vector3d WithoutLikelyLight(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin) {
  if (FitLight(colour, skin).gain <= kMostLit) return WithoutAddedLight(colour, skin);
  return (colour.array() - std::max(0.0, (colour - kMostLit * skin).minCoeff())) / kMostLit;
}

// Whether a colour that differs from the skin's only as light makes it may be a stain all the same, if its edge is
// one's. Gloss is laid over the skin's own light and leaves it as it was, and how the lamps light the skin changes with
// no edge; bleached or covered skin has lost a part of it, or shows a brighter layer's. On grey skin the two look
// alike.
bool MayBePigment(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin) {
  const bool grey = (skin.array() - skin.mean()).matrix().norm() < kGrey * skin.norm();
  return grey || std::abs(FitLight(colour, skin).gain - 1) > kOwnLight;
}

double WeightedDifference(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin, double lightness_weight) {
  Eigen::Vector3f difference = LabFromLinear(colour.cast<float>()) - LabFromLinear(skin.cast<float>());
  difference[0] *= static_cast<float>(lightness_weight);
  return difference.norm();
}

// The colour difference that neither more light nor less explains: shade takes the same factor off all channels.
double ContrastBeyondShading(const TransitionField& field, double lightness_weight) {
  const Eigen::Vector3d &colour = field.defect_linear, &skin = field.healthy_linear;
  const double shade = std::min(1.0, std::max(1e-3, colour.dot(skin) / skin.squaredNorm()));
  return std::min(ContrastBeyondLight(field, lightness_weight),
                  WeightedDifference(colour / shade, skin, lightness_weight));
}

// Whether a round, even spot is nearly in the colour of gloss, but has a border too sharp for it.
bool IsTooSharpForGloss(const TransitionField& field, double threshold, const DefectOptions& options) {
  const double level = options.contour.level, min_area = options.cluster.min_area_mm2;
  const double weight = options.segmentation.lightness_weight;
  const double tint = kSharpTint * options.segmentation.significance_delta_e;
  if (Contrast(field, weight) < threshold || ContrastBeyondLight(field, weight) < tint) return false;
  if (!HasStainsEdge(field, level, min_area) || !HasEvenEdge(field, level, min_area)) return false;
  const std::optional<double> width = EdgeWidth(field, level, min_area);
  return width && *width < kSharpestGloss;
}

// Whether a roundish patch has a stain's edge and no colour that light gives.
bool HasRoundStain(const TransitionField& field, double threshold, const DefectOptions& options) {
  const double weight = options.segmentation.lightness_weight;
  if (field.noise * options.segmentation.local_sigma > 1 || Contrast(field, weight) < threshold) return false;
  const double beyond_light = std::min(threshold, kTint * options.segmentation.significance_delta_e);
  if (ContrastBeyondLight(field, weight) < beyond_light && !MayBePigment(field.defect_linear, field.healthy_linear)) {
    return false;
  }
  return HasStainsEdge(field, options.contour.level, options.cluster.min_area_mm2);
}

// Whether a patch of any form has a sharp rim all along, and the less its colour is beyond what light makes of the
// skin's, the sharper.
bool HasSharpStain(const TransitionField& field, double threshold, const DefectOptions& options) {
  const double weight = options.segmentation.lightness_weight, least = options.segmentation.significance_delta_e;
  const double level = options.contour.level, min_area = options.cluster.min_area_mm2;
  const double beyond_light = ContrastBeyondShading(field, weight);
  if (!HasColourOfItsOwn(field, threshold, options)) return false;
  const std::optional<double> width = EdgeWidth(field, level, min_area);
  if (!width || (beyond_light < kTint * least && *width >= kSharpestGloss)) return false;
  return HasSharpRim(field, level, min_area, options.segmentation.local_sigma);
}

}  // namespace

double ContrastBeyondLight(const TransitionField& field, double lightness_weight) {
  const Eigen::Vector3d pigment = WithoutAddedLight(field.defect_linear, field.healthy_linear);
  return WeightedDifference(pigment, field.healthy_linear, lightness_weight);
}

double Contrast(const TransitionField& field, double lightness_weight) {
  return WeightedDifference(field.defect_linear, field.healthy_linear, lightness_weight);
}

bool StandsOut(const TransitionField& field, double threshold, const DefectOptions& options) {
  if (field.noise * options.segmentation.local_sigma > 1) return false;
  const double weight = options.segmentation.lightness_weight;
  if (ContrastBeyondLight(field, weight) >= threshold) return true;
  // Skin between two shadows can be many times as bright as they are, but its border is not as sharp all the way round.
  const Eigen::Vector3d pigment = WithoutLikelyLight(field.defect_linear, field.healthy_linear);
  if (WeightedDifference(pigment, field.healthy_linear, weight) >= threshold &&
      HasEvenEdge(field, options.contour.level, options.cluster.min_area_mm2)) {
    return true;
  }
  return HasRoundStain(field, threshold, options) || IsTooSharpForGloss(field, threshold, options);
}

bool StandsOutFaintly(const TransitionField& field, double threshold, const DefectOptions& options) {
  return HasRoundStain(field, threshold, options) || HasSharpStain(field, threshold, options);
}

bool StandsOutByItsRim(const TransitionField& field, double threshold, const DefectOptions& options) {
  return HasSharpStain(field, threshold, options);
}

bool HasColourOfItsOwn(const TransitionField& field, double threshold, const DefectOptions& options) {
  const double weight = options.segmentation.lightness_weight;
  return Contrast(field, weight) >= threshold &&
         ContrastBeyondShading(field, weight) >= kSharpTint * options.segmentation.significance_delta_e;
}

}  // namespace drupe
