#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "image/image.h"

namespace drupe {

/// When a frame is found wanting.
struct FrameCheckOptions {
  double min_sharpness_ratio = 0.75;  ///< of the scan's median so far
  double min_first_sharpness = 0.02;  ///< while there is no median yet
  /// Of the scan's medians so far: brightness, change to the frame before, markers. A frame that falls this far behind
  /// its fellows is at fault though it passes the limits below, which hold while there is no median yet.
  double min_ratio = 0.3;
  double max_saturated_pct = 25;  ///< pixels with a channel at its end
  double min_bright_level = 40;   ///< grey level that the brightest percent must reach, 0..255
  double max_motion_px = 1.5;     ///< that the table's turning smears during the exposure
  double min_change = 0.35;       ///< mean difference to the frame before, grey levels; less: the same picture
  int min_markers = 4;            ///< of the board
  std::string dictionary = "DICT_4X4_250";  ///< of the board's markers; empty: no board is looked for

  Status Check() const;
};

/// What was measured in a frame, and what is wrong with it.
struct FrameCheck {
  double sharpness = 0;  ///< energy of the finest details over that of twice as large ones, in the worse direction
  double saturated_pct = 0;
  double bright_level = 0;  ///< that 1 % of the pixels exceed
  double motion_px = 0;
  double change = -1;  ///< to the frame before; -1: there was none
  int markers = -1;    ///< -1: not looked for
  /// "blurred", "saturated", "dark", "moved", "duplicate", "no_board".
  std::vector<std::string> faults;

  bool ok() const { return faults.empty(); }
};
Json ToJson(const FrameCheck& check);
/// Reads what ToJson wrote; what is missing keeps its default.
FrameCheck ParseFrameCheck(const Json& json);

/// Checks the frames of one scan, one after the other. They are judged against the scan's own frames, since sharpness,
/// change and the rest depend on what is seen; a duplicate is told by the frame before.
class FrameInspector {
 public:
  explicit FrameInspector(const FrameCheckOptions& options) : options_(options) {}

  /// `motion_px` is what the table's speed and the exposure let expect; `turned` says that the table has moved since
  /// the frame before, so that the picture must have changed.
  FrameCheck Inspect(const RgbImage& image, double motion_px, bool turned);
  /// Takes a frame that was kept into the reference; Inspect does not.
  void Remember(const FrameCheck& kept);

 private:
  void Judge(FrameCheck& check, bool turned) const;

  const FrameCheckOptions options_;
  std::vector<double> sharpness_, bright_, change_, markers_;  ///< of the frames kept
  GrayImage last_small_;
};

}  // namespace drupe
