#include "reconstruction/dense/view_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace drupe::dense {

namespace {

using LumaImage = Image<std::uint16_t>;  ///< luma of 0..255, times 256

/// Weights of the four taps at -1, 0, 1, 2 for a position `t` in [0, 1) between taps 0 and 1 (Catmull & Rom 1974).
std::array<float, 4> CatmullRom(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {0.5f * (-t3 + 2 * t2 - t), 0.5f * (3 * t3 - 5 * t2 + 2), 0.5f * (-3 * t3 + 4 * t2 + t), 0.5f * (t3 - t2)};
}

Eigen::Array3f SampleBicubic(const RgbImage& picture, double x, double y) {
  const int xi = static_cast<int>(std::floor(x)), yi = static_cast<int>(std::floor(y));
  const auto wx = CatmullRom(static_cast<float>(x - xi)), wy = CatmullRom(static_cast<float>(y - yi));
  std::array<int, 4> columns;
  for (int i = 0; i < 4; ++i) columns[i] = 3 * std::clamp(xi - 1 + i, 0, picture.width() - 1);
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  for (int j = 0; j < 4; ++j) {
    const std::uint8_t* row = picture.Row(std::clamp(yi - 1 + j, 0, picture.height() - 1));
    Eigen::Array3f line = Eigen::Array3f::Zero();
    for (int i = 0; i < 4; ++i) {
      const std::uint8_t* pixel = row + columns[i];
      line += wx[i] * Eigen::Array3f(pixel[0], pixel[1], pixel[2]);
    }
    sum += wy[j] * line;
  }
  return sum.max(0.0f).min(255.0f);
}

void UndistortRow(const RgbImage& picture, const PinholeCamera& camera, const PixelRect& rect, int y, DenseView* view,
                  LumaImage* luma) {
  for (int x = 0; x < rect.Width(); ++x) {
    const Eigen::Vector2d xy((x + rect.x0 - camera.cx) / camera.fx, (y + rect.y0 - camera.cy) / camera.fy);
    const Eigen::Vector2d source = camera.PixelFromNormalised(xy);
    const Eigen::Array3f rgb = SampleBicubic(picture, source.x(), source.y());
    for (int channel = 0; channel < 3; ++channel) {
      view->rgb.At(x, y, channel) = static_cast<std::uint8_t>(rgb[channel] + 0.5f);
    }
    const float value = 0.299f * rgb[0] + 0.587f * rgb[1] + 0.114f * rgb[2];
    luma->At(x, y) = static_cast<std::uint16_t>(value * 256.0f + 0.5f);
  }
}

/// Pixel i of the half covers pixels 2i and 2i + 1; the kernel reaches one further on either side.
std::array<int, 4> HalvingTaps(int i, int size) {
  return {std::max(2 * i - 1, 0), std::min(2 * i, size - 1), std::min(2 * i + 1, size - 1),
          std::min(2 * i + 2, size - 1)};
}

LumaImage Halve(const LumaImage& fine) {
  constexpr std::array<std::uint32_t, 4> kKernel = {1, 3, 3, 1};
  LumaImage half(std::max(1, fine.width() / 2), std::max(1, fine.height() / 2));
  std::vector<std::uint32_t> column(fine.width());
  for (int y = 0; y < half.height(); ++y) {
    const auto rows = HalvingTaps(y, fine.height());
    for (int x = 0; x < fine.width(); ++x) {
      column[x] = 0;
      for (int j = 0; j < 4; ++j) column[x] += kKernel[j] * fine.At(x, rows[j]);
    }
    for (int x = 0; x < half.width(); ++x) {
      const auto taps = HalvingTaps(x, fine.width());
      std::uint32_t sum = 32;
      for (int i = 0; i < 4; ++i) sum += kKernel[i] * column[taps[i]];
      half.At(x, y) = static_cast<std::uint16_t>(sum >> 6);
    }
  }
  return half;
}

LumaPairs PairUp(const LumaImage& luma) {
  LumaPairs pairs(luma.width(), luma.height());
  for (int y = 0; y < luma.height(); ++y) {
    for (int x = 0; x < luma.width(); ++x) {
      pairs.At(x, y) = luma.At(x, y) | std::uint32_t{luma.At(std::min(x + 1, luma.width() - 1), y)} << 16;
    }
  }
  return pairs;
}

}  // namespace

LevelCamera DenseView::CameraAt(int level) const {
  const double scale = std::ldexp(1.0, -level);
  return {camera.fx * scale, camera.fy * scale, (camera.cx + 0.5) * scale - 0.5, (camera.cy + 0.5) * scale - 0.5};
}

void BuildPyramid(const RgbImage& picture, const PinholeCamera& camera, const PixelRect& rect, int level_count,
                  DenseView* view) {
  view->camera = {camera.fx, camera.fy, camera.cx - rect.x0, camera.cy - rect.y0};
  view->rgb = RgbImage(rect.Width(), rect.Height(), 3);
  LumaImage luma(rect.Width(), rect.Height());
  for (int y = 0; y < rect.Height(); ++y) UndistortRow(picture, camera, rect, y, view, &luma);
  view->luma.clear();
  view->luma.push_back(PairUp(luma));
  for (int level = 1; level < level_count; ++level) {
    luma = Halve(luma);
    view->luma.push_back(PairUp(luma));
  }
}

void DropLevelsBelow(int level, DenseView* view) {
  for (int l = 0; l < level; ++l) view->luma[l] = LumaPairs();
}

}  // namespace drupe::dense
