#include "defect_analysis/report/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace drupe {
namespace {

constexpr std::string_view kLetters = "0123456789abcdefghiklmnoprstuvwxyz._-#%";

// Columns of each letter from left to right, the lowest bit at the top.
constexpr std::array<std::array<std::uint8_t, 5>, kLetters.size()> kGlyphs = {{
    {0x3e, 0x51, 0x49, 0x45, 0x3e}, {0x00, 0x42, 0x7f, 0x40, 0x00}, {0x42, 0x61, 0x51, 0x49, 0x46},
    {0x21, 0x41, 0x45, 0x4b, 0x31}, {0x18, 0x14, 0x12, 0x7f, 0x10}, {0x27, 0x45, 0x45, 0x45, 0x39},
    {0x3c, 0x4a, 0x49, 0x49, 0x30}, {0x01, 0x71, 0x09, 0x05, 0x03}, {0x36, 0x49, 0x49, 0x49, 0x36},
    {0x06, 0x49, 0x49, 0x29, 0x1e}, {0x20, 0x54, 0x54, 0x54, 0x78}, {0x7f, 0x48, 0x44, 0x44, 0x38},
    {0x38, 0x44, 0x44, 0x44, 0x20}, {0x38, 0x44, 0x44, 0x48, 0x7f}, {0x38, 0x54, 0x54, 0x54, 0x18},
    {0x08, 0x7e, 0x09, 0x01, 0x02}, {0x0c, 0x52, 0x52, 0x52, 0x3e}, {0x7f, 0x08, 0x04, 0x04, 0x78},
    {0x00, 0x44, 0x7d, 0x40, 0x00}, {0x7f, 0x10, 0x28, 0x44, 0x00}, {0x00, 0x41, 0x7f, 0x40, 0x00},
    {0x7c, 0x04, 0x18, 0x04, 0x78}, {0x7c, 0x08, 0x04, 0x04, 0x78}, {0x38, 0x44, 0x44, 0x44, 0x38},
    {0x7c, 0x14, 0x14, 0x14, 0x08}, {0x7c, 0x08, 0x04, 0x04, 0x08}, {0x48, 0x54, 0x54, 0x54, 0x20},
    {0x04, 0x3f, 0x44, 0x40, 0x20}, {0x3c, 0x40, 0x40, 0x20, 0x7c}, {0x1c, 0x20, 0x40, 0x20, 0x1c},
    {0x3c, 0x40, 0x30, 0x40, 0x3c}, {0x44, 0x28, 0x10, 0x28, 0x44}, {0x0c, 0x50, 0x50, 0x50, 0x3c},
    {0x44, 0x64, 0x54, 0x4c, 0x44}, {0x00, 0x60, 0x60, 0x00, 0x00}, {0x40, 0x40, 0x40, 0x40, 0x40},
    {0x08, 0x08, 0x08, 0x08, 0x08}, {0x14, 0x7f, 0x14, 0x7f, 0x14}, {0x23, 0x13, 0x08, 0x64, 0x62},
}};

void Blend(const Rgb8& colour, double cover, std::uint8_t* pixel) {
  for (int c = 0; c < 3; ++c) {
    pixel[c] = static_cast<std::uint8_t>(std::lround((1 - cover) * pixel[c] + cover * colour[c]));
  }
}

double DistanceToPiece(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  const double along = std::clamp((p - a).dot(way) / std::max(1e-12, way.squaredNorm()), 0.0, 1.0);
  return (p - a - along * way).norm();
}

bool IsInside(const RgbImage& image, int x, int y) {
  return x >= 0 && y >= 0 && x < image.width() && y < image.height();
}

}  // namespace

RgbImage Canvas(int width, int height, const Rgb8& colour) {
  RgbImage image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) image.At(x, y, c) = colour[c];
    }
  }
  return image;
}

void DrawClosedLine(const std::vector<Eigen::Vector2d>& points, double width, const Rgb8& colour, RgbImage& image) {
  // Each pixel takes the nearest piece's cover once, so that joints are not drawn twice.
  std::vector<float> cover(static_cast<std::size_t>(image.width()) * image.height(), 0);
  const double reach = width / 2 + 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d &a = points[i], &b = points[(i + 1) % points.size()];
    const Eigen::Vector2d low = a.cwiseMin(b), high = a.cwiseMax(b);
    for (int y = static_cast<int>(std::floor(low.y() - reach)); y <= high.y() + reach; ++y) {
      for (int x = static_cast<int>(std::floor(low.x() - reach)); x <= high.x() + reach; ++x) {
        if (!IsInside(image, x, y)) continue;
        const double inside = width / 2 + 0.5 - DistanceToPiece(Eigen::Vector2d(x, y), a, b);
        float& pixel = cover[static_cast<std::size_t>(y) * image.width() + x];
        pixel = std::max(pixel, static_cast<float>(std::clamp(inside, 0.0, 1.0)));
      }
    }
  }
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const float share = cover[static_cast<std::size_t>(y) * image.width() + x];
      if (share > 0) Blend(colour, share, &image.At(x, y));
    }
  }
}

void DrawText(std::string_view text, int left, int top, int scale, const Rgb8& colour, RgbImage& image) {
  for (const char letter : text) {
    const std::size_t glyph = kLetters.find(letter);
    for (int column = 0; glyph != std::string_view::npos && column < 5 * scale; ++column) {
      for (int row = 0; row < 7 * scale; ++row) {
        if ((kGlyphs[glyph][static_cast<std::size_t>(column / scale)] >> (row / scale) & 1) == 0) continue;
        if (IsInside(image, left + column, top + row)) Blend(colour, 1, &image.At(left + column, top + row));
      }
    }
    left += 6 * scale;
  }
}

void Paste(const RgbImage& from, int left, int top, RgbImage& to) {
  for (int y = 0; y < from.height(); ++y) {
    for (int x = 0; x < from.width(); ++x) {
      if (!IsInside(to, left + x, top + y)) continue;
      for (int c = 0; c < 3; ++c) to.At(left + x, top + y, c) = from.At(x, y, c);
    }
  }
}

RgbImage CutOut(const RgbImage& picture, const Eigen::Vector2d& centre, double side, int size) {
  RgbImage cut = Canvas(size, size, Rgb8::Zero());
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double px = centre.x() + ((column + 0.5) / size - 0.5) * side;
      const double py = centre.y() + ((row + 0.5) / size - 0.5) * side;
      const int x = static_cast<int>(std::floor(px)), y = static_cast<int>(std::floor(py));
      if (!IsInside(picture, x, y) || !IsInside(picture, x + 1, y + 1)) continue;
      const double u = px - x, v = py - y;
      for (int c = 0; c < 3; ++c) {
        const double upper = (1 - u) * picture.At(x, y, c) + u * picture.At(x + 1, y, c);
        const double lower = (1 - u) * picture.At(x, y + 1, c) + u * picture.At(x + 1, y + 1, c);
        cut.At(column, row, c) = static_cast<std::uint8_t>(std::lround((1 - v) * upper + v * lower));
      }
    }
  }
  return cut;
}

}  // namespace drupe
