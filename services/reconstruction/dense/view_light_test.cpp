#include "reconstruction/dense/view_light.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace drupe::dense {
namespace {

/// A square of skin, `size` units wide with 8 points a unit, and what views show of it.
struct Skin {
  std::vector<Eigen::Vector3f> positions;
  std::vector<LightSample> samples;

  explicit Skin(int size) {
    for (int y = 0; y < 8 * size; ++y) {
      for (int x = 0; x < 8 * size; ++x) positions.emplace_back((x + 0.5f) / 8, (y + 0.5f) / 8, 0.0f);
    }
  }

  /// `colour(point)`, `light(view, position)`, `sees(view, point)`.
  template <typename Colour, typename Light, typename Sees>
  void Show(int views, const Colour& colour, const Light& light, const Sees& sees) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      for (int view = 0; view < views; ++view) {
        if (!sees(view, i)) continue;
        const float value = colour(positions[i]) + light(view, positions[i]);
        samples.push_back({static_cast<std::uint32_t>(i), view, 0.5f + 0.1f * static_cast<float>(view),
                           Eigen::Array3f(value, value, value)});
      }
    }
  }

  /// The mean of what the views show of every point with their light taken out.
  std::vector<float> Colours(const SurfaceGrid& grid, const ViewLight& light) const {
    std::vector<float> sums(positions.size(), 0.0f), weights(positions.size(), 0.0f);
    for (const LightSample& sample : samples) {
      const Eigen::Array3f own = light.Log(grid.At(positions[sample.point]), sample.view);
      sums[sample.point] += sample.weight * (sample.log_colour[1] - own[1]);
      weights[sample.point] += sample.weight;
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= weights[i];
    return sums;
  }
};

/// A shadow with a soft edge along x = 6.
float Shadow(const Eigen::Vector3f& position) {
  return -0.25f / (1 + std::exp(-4 * (position.x() - 6)));
}

/// View 2 alone has the shadow. Every point is seen by three of five views, another three each time.
struct ShadedSkin : Skin {
  ShadedSkin() : Skin(12) {
    Show(
        5, [](const Eigen::Vector3f& p) { return (p - Eigen::Vector3f(9, 6, 0)).norm() < 1.5f ? 4.0f : 4.6f; },
        [](int view, const Eigen::Vector3f& p) { return view == 2 ? Shadow(p) : 0.0f; },
        [](int view, std::size_t point) { return (static_cast<std::size_t>(view) + point * 7919 / 13) % 5 < 3; });
  }

  /// Standard deviation of the colours within a ring about the spot, which lies in the shadow.
  float Noise(const std::vector<float>& colours) const {
    float sum = 0, squares = 0, count = 0;
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const float from_spot = (positions[i] - Eigen::Vector3f(9, 6, 0)).norm();
      if (from_spot < 1.6f || from_spot > 2.9f) continue;
      sum += colours[i];
      squares += colours[i] * colours[i];
      count += 1;
    }
    return std::sqrt(std::max(0.0f, squares / count - sum * sum / count / count));
  }
};

TEST(ViewLight, TakesOutAShadowThatOneViewHas) {
  const ShadedSkin skin;
  const SurfaceGrid grid(skin.positions, 1.5f);
  const float before = skin.Noise(skin.Colours(grid, ViewLight()));
  const float after = skin.Noise(skin.Colours(grid, ViewLight::Fit(grid, skin.positions, skin.samples, 5)));
  EXPECT_GT(before, 0.04f);  // a mosaic of the points that the view in shade sees and the others
  EXPECT_LT(after, 0.012f);
}

TEST(ViewLight, LeavesWhatAllViewsSee) {
  const ShadedSkin skin;
  const SurfaceGrid grid(skin.positions, 1.5f);
  const std::vector<float> colours = skin.Colours(grid, ViewLight::Fit(grid, skin.positions, skin.samples, 5));
  float spot = 0, around = 0, in_spot = 0, in_ring = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const float from_spot = (skin.positions[i] - Eigen::Vector3f(9, 6, 0)).norm();
    if (from_spot < 1.4f) spot += colours[i], in_spot += 1;
    if (from_spot > 1.6f && from_spot < 2.5f) around += colours[i], in_ring += 1;
  }
  EXPECT_NEAR(around / in_ring - spot / in_spot, 0.6f, 0.01f);
}

TEST(ViewLight, IsZeroWhereNothingIsKnown) {
  const ShadedSkin skin;
  const SurfaceGrid grid(skin.positions, 1.5f);
  const ViewLight light = ViewLight::Fit(grid, skin.positions, skin.samples, 7);
  EXPECT_EQ(light.Log(grid.At(skin.positions[0]), 6).abs().maxCoeff(), 0);
  EXPECT_EQ(light.Log(grid.At({100, 100, 100}), 2).abs().maxCoeff(), 0);
  EXPECT_EQ(ViewLight().Log(grid.At(skin.positions[0]), 0).abs().maxCoeff(), 0);
}

TEST(ViewLight, OfNoSamplesIsNone) {
  const Skin skin(2);
  const SurfaceGrid grid(skin.positions, 1.5f);
  EXPECT_EQ(ViewLight::Fit(grid, skin.positions, {}, 3).Log(grid.At(skin.positions[0]), 0).abs().maxCoeff(), 0);
}

/// The minimum of the same function by one dense system of equations, where all residuals count in full: unknown are
/// the field of each view at each cell and the colour of each point.
Eigen::VectorXd Reference(const SurfaceGrid& grid, const Skin& skin, int views) {
  const int fields = grid.cell_count() * views, points = static_cast<int>(skin.positions.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(fields + points, fields + points);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(fields + points);
  std::vector<double> weights(fields, 0.0);
  for (const LightSample& sample : skin.samples) {
    const int field = grid.CellOf(skin.positions[sample.point]) * views + sample.view;
    const int colour = fields + static_cast<int>(sample.point);
    weights[field] += sample.weight;
    for (const int row : {field, colour}) {
      right[row] += sample.weight * sample.log_colour[1];
      for (const int col : {field, colour}) normal(row, col) += sample.weight;
    }
  }
  std::nth_element(weights.begin(), weights.begin() + fields / 2, weights.end());
  const double usual = weights[fields / 2];
  for (int cell = 0; cell < grid.cell_count(); ++cell) {
    for (int view = 0; view < views; ++view) {
      normal(cell * views + view, cell * views + view) += 0.02 * usual;
      for (const int other : grid.Around(cell)) {
        normal(cell * views + view, cell * views + view) += usual;
        normal(cell * views + view, other * views + view) -= usual;
      }
    }
  }
  return normal.ldlt().solve(right);
}

TEST(ViewLight, IsTheMinimumThatOneSystemOfEquationsGives) {
  Skin skin(4);
  skin.Show(
      3, [](const Eigen::Vector3f& p) { return 4 + 0.1f * p.x(); },
      [](int view, const Eigen::Vector3f& p) { return 0.015f * std::sin(p.y() + static_cast<float>(view)); },
      [](int, std::size_t) { return true; });
  const SurfaceGrid grid(skin.positions, 1);
  const ViewLight light = ViewLight::Fit(grid, skin.positions, skin.samples, 3);
  const Eigen::VectorXd reference = Reference(grid, skin, 3);
  for (const Eigen::Vector3f& position : skin.positions) {
    const Eigen::Vector3f middle = position.array().floor() + 0.5f;
    if (middle.x() - position.x() > 0.1f || middle.y() - position.y() > 0.1f) continue;
    const SurfaceGrid::Place place =
        grid.At({middle.x() + skin.positions[0].x(), middle.y() + skin.positions[0].y(), 0});
    for (int view = 0; view < 3; ++view) {
      double expected = 0, total = 0;
      for (int corner = 0; corner < 8; ++corner) {
        if (place.cells[corner] == SurfaceGrid::kNone) continue;
        expected += place.weights[corner] * reference[place.cells[corner] * 3 + view];
        total += place.weights[corner];
      }
      EXPECT_NEAR(light.Log(place, view)[1], expected / total, 1e-3);
    }
  }
}

}  // namespace
}  // namespace drupe::dense
