#pragma once

#include <chrono>
#include <deque>
#include <optional>

namespace drupe {

/// The angles that a turning table has reported, to tell where it was when a frame was taken in between. Between two
/// reports of the turning table its speed is taken as constant; from one of them to where it rests, or rested before,
/// it turned at the speed that it was told.
class AngleTrack {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// `speed_deg_s` is positive: angles grow.
  explicit AngleTrack(double speed_deg_s) : speed_deg_s_(speed_deg_s) {}

  /// In order of time; the last few seconds are kept.
  void Add(TimePoint at, double angle_deg, bool moving);
  /// Nothing when `at` lies more than half a second outside the reports.
  std::optional<double> AngleAt(TimePoint at) const;

 private:
  struct Sample {
    TimePoint at;
    double angle_deg;
    bool moving;
  };

  double Beside(const Sample& sample, TimePoint at) const;
  double Between(const Sample& a, const Sample& b, TimePoint at) const;

  const double speed_deg_s_;
  std::deque<Sample> samples_;
};

/// Which of `views` equally spaced views an angle belongs to.
struct ViewOfAngle {
  int view = 0;          ///< 0..views-1
  double error_deg = 0;  ///< of the angle from the view's own
};
ViewOfAngle NearestView(double angle_deg, int views);

}  // namespace drupe
