#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "image/colour.h"
#include "image/image.h"

namespace drupe {

/// A picture of one colour.
RgbImage Canvas(int width, int height, const Rgb8& colour);

/// Draws a closed line `width` pixels wide, smoothed at its edges. Points in pixels, centres at integers.
void DrawClosedLine(const std::vector<Eigen::Vector2d>& points, double width, const Rgb8& colour, RgbImage& image);

/// Draws text from its top left corner, 5 x 7 pixels a letter, `scale` times as large: digits, small letters, and what
/// a measure needs (. _ - # %). Other letters leave a space.
void DrawText(std::string_view text, int left, int top, int scale, const Rgb8& colour, RgbImage& image);

/// Copies `from` into `to` with its top left corner at (left, top); what lies outside is cut.
void Paste(const RgbImage& from, int left, int top, RgbImage& to);

/// The part of a picture about `centre` that is `side` pixels wide and high, resampled (bilinear) to `size`; black
/// outside the picture.
RgbImage CutOut(const RgbImage& picture, const Eigen::Vector2d& centre, double side, int size);

}  // namespace drupe
