#pragma once

#include <functional>
#include <mutex>
#include <ostream>
#include <string>
#include <string_view>

namespace drupe {

/// Where and how a ProgressBar writes.
struct ProgressBarOptions {
  /// True: one line that is redrawn in place. False: one plain line at a stage's end, fit for a log.
  bool redraw = false;
  int bar_width = 30;                  ///< characters between the brackets
  double min_redraw_interval_s = 0.1;  ///< redraws that come sooner are dropped, but for a stage's first and last
  std::function<double()> now_s;       ///< a monotonic clock in seconds; empty: the machine's

  /// Options for stderr: redraws only where a person watches a terminal that can.
  static ProgressBarOptions ForStderr();
};

/// Shows the stage a long computation is in, the share of it that is done and the time it has taken:
///
///   dense         [#################.............]  57 %    12.3 s
///
/// Thread-safe, so that it can be called straight from RunContext::progress.
class ProgressBar {
 public:
  /// Writes to `out`, which must outlive the bar.
  explicit ProgressBar(std::ostream& out, ProgressBarOptions options = ProgressBarOptions::ForStderr());
  /// Leaves the cursor on a line of its own, whatever happened.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` of `stage` is done; values outside 0..1 are clamped. A stage that was not the last one named begins,
  /// and the one before it ends.
  void Update(std::string_view stage, double fraction);
  /// The last stage is complete.
  void Finish();

 private:
  void EndStage();
  void Redraw();

  std::ostream& out_;
  const ProgressBarOptions options_;
  std::mutex mutex_;
  std::string stage_;  ///< empty: no stage is under way
  double fraction_ = 0;
  double stage_start_s_ = 0;
  double last_redraw_s_ = 0;
  bool line_open_ = false;  ///< something is drawn on the current line
};

}  // namespace drupe
