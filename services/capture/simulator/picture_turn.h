#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/status.h"
#include "image/image.h"

namespace drupe {

/// What a simulated camera is asked for: a window of its sensor in a pixel format of GenICam's naming convention.
struct SensorWindow {
  int x = 0, y = 0, width = 0, height = 0;
  std::uint32_t pixel_format = 0;
};

inline constexpr std::uint32_t kPfncMono8 = 0x01080001;
inline constexpr std::uint32_t kPfncBayerGr8 = 0x01080008;
inline constexpr std::uint32_t kPfncBayerRg8 = 0x01080009;
inline constexpr std::uint32_t kPfncBayerGb8 = 0x0108000A;
inline constexpr std::uint32_t kPfncBayerBg8 = 0x0108000B;
inline constexpr std::uint32_t kPfncRgb8 = 0x02180014;

/// Bytes of a pixel in that format; 0 for a format that is not simulated.
int BytesPerPixel(std::uint32_t pixel_format);

/// The pictures of one turn: what a camera sees at each angle of the table.
class PictureTurn {
 public:
  /// Reads every picture of a directory, ascending by name; the first is seen at angle 0. Errors: 404
  /// `file_not_found`, 422 `bad_pictures` (none, or of different sizes), and those of DecodeRgb.
  static Result<PictureTurn> Load(const std::filesystem::path& directory);

  int width() const { return pictures_.front().width(); }
  int height() const { return pictures_.front().height(); }
  int count() const { return static_cast<int>(pictures_.size()); }
  double step_deg() const { return 360.0 / count(); }

  /// What the sensor has behind its colour filters at the table's angle (any number of turns). `blur_px` is the radius
  /// of a box that smears it, 0 for none. `pixels` holds width x height x BytesPerPixel bytes.
  void Expose(double angle_deg, int blur_px, const SensorWindow& window, std::span<std::uint8_t> pixels) const;

 private:
  explicit PictureTurn(std::vector<RgbImage> pictures) : pictures_(std::move(pictures)) {}

  std::vector<RgbImage> pictures_;
};

}  // namespace drupe
