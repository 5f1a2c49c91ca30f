#include "capture/scan/angle_track.h"

#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

constexpr std::size_t kKept = 256;
constexpr double kBeyondSeconds = 0.5;

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void AngleTrack::Add(TimePoint at, double angle_deg, bool moving) {
  if (!samples_.empty() && at <= samples_.back().at) return;
  samples_.push_back({at, angle_deg, moving});
  if (samples_.size() > kKept) samples_.pop_front();
}

/// Going on from one report, either way.
double AngleTrack::Beside(const Sample& sample, TimePoint at) const {
  return sample.moving ? sample.angle_deg + speed_deg_s_ * Seconds(at - sample.at) : sample.angle_deg;
}

double AngleTrack::Between(const Sample& a, const Sample& b, TimePoint at) const {
  if (a.moving && !b.moving) return std::min(Beside(a, at), b.angle_deg);
  if (!a.moving && b.moving) return std::max(Beside(b, at), a.angle_deg);
  return a.angle_deg + Seconds(at - a.at) / Seconds(b.at - a.at) * (b.angle_deg - a.angle_deg);
}

std::optional<double> AngleTrack::AngleAt(TimePoint at) const {
  if (samples_.empty()) return std::nullopt;
  const auto beyond = std::chrono::duration<double>(kBeyondSeconds);
  if (at < samples_.front().at - beyond || at > samples_.back().at + beyond) return std::nullopt;
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), at,
                                      [](const Sample& sample, TimePoint time) { return sample.at < time; });
  if (after == samples_.begin()) return Beside(samples_.front(), at);
  if (after == samples_.end()) return Beside(samples_.back(), at);
  return Between(*(after - 1), *after, at);
}

ViewOfAngle NearestView(double angle_deg, int views) {
  const double step = 360.0 / views;
  const double nearest = std::round(angle_deg / step);
  const int view = static_cast<int>(std::fmod(nearest, views));
  return {view < 0 ? view + views : view, angle_deg - nearest * step};
}

}  // namespace drupe
