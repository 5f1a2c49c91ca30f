#include "capture/scan/angle_track.h"

#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

constexpr std::size_t kKept = 256;
constexpr double kBeyondSeconds = 0.5;

}  // namespace

void AngleTrack::Add(TimePoint at, double angle_deg) {
  if (!samples_.empty() && at <= samples_.back().at) return;
  samples_.push_back({at, angle_deg});
  if (samples_.size() > kKept) samples_.pop_front();
}

std::optional<double> AngleTrack::AngleAt(TimePoint at) const {
  if (samples_.size() < 2) return std::nullopt;
  const auto beyond = std::chrono::duration<double>(kBeyondSeconds);
  if (at < samples_.front().at - beyond || at > samples_.back().at + beyond) return std::nullopt;
  auto after = std::lower_bound(samples_.begin(), samples_.end(), at,
                                [](const Sample& sample, TimePoint time) { return sample.at < time; });
  after = std::clamp(after, samples_.begin() + 1, samples_.end() - 1);
  const Sample &a = *(after - 1), &b = *after;
  const double share = std::chrono::duration<double>(at - a.at) / std::chrono::duration<double>(b.at - a.at);
  return a.angle_deg + share * (b.angle_deg - a.angle_deg);
}

ViewOfAngle NearestView(double angle_deg, int views) {
  const double step = 360.0 / views;
  const double nearest = std::round(angle_deg / step);
  const int view = static_cast<int>(std::fmod(nearest, views));
  return {view < 0 ? view + views : view, angle_deg - nearest * step};
}

}  // namespace drupe
