#include "capture/calibration/coverage.h"

#include <algorithm>

namespace drupe {

void CoverageMap::Add(const std::vector<Eigen::Vector2d>& measured) {
  for (const Eigen::Vector2d& pixel : measured) {
    // Pixel centres are at integers, so that the picture begins at -0.5.
    const int column = std::clamp(static_cast<int>((pixel.x() + 0.5) * kColumns / width), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>((pixel.y() + 0.5) * kRows / height), 0, kRows - 1);
    ++corners[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    pixels.push_back(pixel);
  }
}

double CoverageMap::Share() const {
  int covered = 0;
  for (const auto& row : corners) covered += static_cast<int>(row.size() - std::count(row.begin(), row.end(), 0));
  return static_cast<double>(covered) / (kColumns * kRows);
}

std::vector<std::string> CoverageMap::WeakParts() const {
  static constexpr const char* kNames[3][3] = {
      {"top left", "top", "top right"}, {"left", "middle", "right"}, {"bottom left", "bottom", "bottom right"}};
  int cells[3][3] = {}, covered[3][3] = {};
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const int i = row * 3 / kRows, j = column * 3 / kColumns;
      ++cells[i][j];
      covered[i][j] += corners[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] > 0 ? 1 : 0;
    }
  }
  std::vector<std::string> weak;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (2 * covered[i][j] < cells[i][j]) weak.emplace_back(kNames[i][j]);
    }
  }
  return weak;
}

std::string CoverageMap::WeakText() const {
  std::string text;
  for (const std::string& part : WeakParts()) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "none" : text;
}

Json ToJson(const CoverageMap& map) {
  return {{"grid", Json::array({CoverageMap::kColumns, CoverageMap::kRows})},
          {"corners", map.corners},
          {"weak_parts", map.WeakParts()}};
}

}  // namespace drupe
