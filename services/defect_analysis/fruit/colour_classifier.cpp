#include "defect_analysis/fruit/colour_classifier.h"

#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

constexpr double kStepPerKernel = 0.2;  // of the kernel's standard deviation: what linear interpolation follows
constexpr int kMinNodes = 9;
constexpr int kMaxNodes = 160;

// The bounds of all sRGB colours.
Eigen::Vector3f LowOf(ColourSpace space) {
  return space == ColourSpace::kLab ? Eigen::Vector3f(0, -87, -109) : Eigen::Vector3f(0, 0, 0);
}
Eigen::Vector3f HighOf(ColourSpace space) {
  return space == ColourSpace::kLab ? Eigen::Vector3f(101, 99, 96) : Eigen::Vector3f(256, 256, 256);
}

}  // namespace

ColourClassifier::ColourClassifier(const ColourModel& model) : space_(model.space), bias_(model.bias) {
  low_ = LowOf(space_);
  weights_ = Eigen::Map<const Eigen::ArrayXf>(model.weights.data(), static_cast<Eigen::Index>(model.weights.size()));
  const Eigen::Vector3f range = HighOf(space_) - low_;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = model.scale[axis] / std::sqrt(2.0 * model.gamma);
    const int steps = static_cast<int>(std::ceil(std::min(1e6, range[axis] / (kStepPerKernel * sigma))));
    count_[axis] = std::clamp(steps + 1, kMinNodes, kMaxNodes);
    inverse_step_[axis] = static_cast<float>(count_[axis] - 1) / range[axis];
    factors_[axis].resize(weights_.size(), count_[axis]);
    for (int node = 0; node < count_[axis]; ++node) {
      const float place =
          (low_[axis] + static_cast<float>(node) / inverse_step_[axis] - model.mean[axis]) / model.scale[axis];
      for (Eigen::Index i = 0; i < weights_.size(); ++i) {
        const float away = place - model.vectors[static_cast<std::size_t>(i)][axis];
        factors_[axis](i, node) = std::exp(-model.gamma * away * away);
      }
    }
  }
}

ColourClassifier::Place ColourClassifier::PlaceIn(const Rgb8& colour) const {
  const Eigen::Vector3f at = (PlaceOf(colour, space_) - low_).cwiseProduct(inverse_step_);
  Place place;
  for (int axis = 0; axis < 3; ++axis) {
    place.node[axis] = std::clamp(static_cast<int>(at[axis]), 0, count_[axis] - 2);
    place.fraction[axis] = std::clamp(at[axis] - static_cast<float>(place.node[axis]), 0.0f, 1.0f);
  }
  return place;
}

float ColourClassifier::NodeDecision(int i, int j, int k) const {
  return bias_ + (weights_ * factors_[0].col(i) * factors_[1].col(j) * factors_[2].col(k)).sum();
}

std::vector<float> ColourClassifier::Decide(std::span<const Rgb8> colours) const {
  std::vector<float> nodes(NodeIndex(count_[0], 0, 0), NAN);
  std::vector<float> decisions(colours.size());
  for (std::size_t n = 0; n < colours.size(); ++n) {
    const Place place = PlaceIn(colours[n]);
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int i = place.node[0] + (corner >> 2), j = place.node[1] + (corner >> 1 & 1),
                k = place.node[2] + (corner & 1);
      float& node = nodes[NodeIndex(i, j, k)];
      if (std::isnan(node)) node = NodeDecision(i, j, k);
      const float x = (corner & 4) != 0 ? place.fraction[0] : 1 - place.fraction[0];
      const float y = (corner & 2) != 0 ? place.fraction[1] : 1 - place.fraction[1];
      const float z = (corner & 1) != 0 ? place.fraction[2] : 1 - place.fraction[2];
      sum += x * y * z * node;
    }
    decisions[n] = sum;
  }
  return decisions;
}

}  // namespace drupe
