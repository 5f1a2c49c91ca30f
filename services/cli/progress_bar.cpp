#include "cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace drupe {
namespace {

constexpr const char* kEraseLine = "\r\x1b[K";
constexpr int kStageColumn = 14;

double SteadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

ProgressBarOptions WithClock(ProgressBarOptions options) {
  if (!options.now_s) options.now_s = SteadySeconds;
  return options;
}

std::string Padded(std::string_view text, int width) {
  std::string padded(text);
  padded.resize(std::max<std::size_t>(padded.size(), static_cast<std::size_t>(width)), ' ');
  return padded;
}

std::string Seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%8.1f s", seconds);
  return text;
}

std::string Percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%3d %%", static_cast<int>(std::floor(fraction * 100)));
  return text;
}

std::string Bar(double fraction, int width) {
  const auto filled = static_cast<std::size_t>(std::lround(fraction * width));
  return "[" + std::string(filled, '#') + std::string(static_cast<std::size_t>(width) - filled, '.') + "]";
}

}  // namespace

ProgressBarOptions ProgressBarOptions::ForStderr() {
  ProgressBarOptions options;
  const char* term = std::getenv("TERM");
  options.redraw = isatty(STDERR_FILENO) != 0 && term != nullptr && std::string_view(term) != "dumb";
  return options;
}

ProgressBar::ProgressBar(std::ostream& out, ProgressBarOptions options)
    : out_(out), options_(WithClock(std::move(options))) {}

ProgressBar::~ProgressBar() {
  if (line_open_) out_ << std::endl;
}

void ProgressBar::Update(std::string_view stage, double fraction) {
  const std::lock_guard lock(mutex_);
  const double now = options_.now_s();
  const bool begins = stage != stage_;
  if (begins) {
    EndStage();
    stage_ = stage;
    stage_start_s_ = now;
  }
  fraction_ = std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0);
  if (options_.redraw && (begins || fraction_ == 1.0 || now - last_redraw_s_ >= options_.min_redraw_interval_s))
    Redraw();
}

void ProgressBar::Finish() {
  const std::lock_guard lock(mutex_);
  EndStage();
}

void ProgressBar::EndStage() {
  if (stage_.empty()) return;
  if (options_.redraw) out_ << kEraseLine;
  out_ << Padded(stage_, kStageColumn) << Seconds(options_.now_s() - stage_start_s_) << std::endl;
  line_open_ = false;
  stage_.clear();
}

void ProgressBar::Redraw() {
  last_redraw_s_ = options_.now_s();
  out_ << kEraseLine << Padded(stage_, kStageColumn) << Bar(fraction_, options_.bar_width) << "  " << Percent(fraction_)
       << Seconds(last_redraw_s_ - stage_start_s_) << std::flush;
  line_open_ = true;
}

}  // namespace drupe
