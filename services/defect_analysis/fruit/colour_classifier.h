#pragma once

#include <array>
#include <span>
#include <vector>

#include "scene/colour_model.h"

namespace drupe {

/// A colour model, fast enough for every point of a cloud. The radial kernel is a product of one factor a channel, so
/// that the decision at the nodes of a grid over the model's colour space needs no exponential; only the nodes that the
/// colours at hand touch are computed, and decisions between them are interpolated linearly in each channel.
class ColourClassifier {
 public:
  explicit ColourClassifier(const ColourModel& model);

  /// The decision for each colour, as ColourModel::Decide to within the grid's step; above zero: fruit.
  std::vector<float> Decide(std::span<const Rgb8> colours) const;

  /// Nodes along each channel.
  const std::array<int, 3>& nodes() const { return count_; }

 private:
  struct Place {
    std::array<int, 3> node;
    Eigen::Vector3f fraction;
  };

  Place PlaceIn(const Rgb8& colour) const;
  std::size_t NodeIndex(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * count_[1] + j) * count_[2] + k;
  }
  float NodeDecision(int i, int j, int k) const;

  ColourSpace space_;
  float bias_;
  Eigen::Vector3f low_;           ///< of the grid, in the colour space
  Eigen::Vector3f inverse_step_;  ///< nodes a unit of the colour space
  std::array<int, 3> count_{};
  Eigen::ArrayXf weights_;
  std::array<Eigen::ArrayXXf, 3> factors_;  ///< column: a node of the channel; row: a support vector
};

}  // namespace drupe
