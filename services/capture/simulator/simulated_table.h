#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace drupe {

/// The mechanics of a simulated turntable: one axis in degrees, moved at constant speed, which sends a pulse whenever
/// it passes a multiple of the pulse spacing, as the encoder of a real one does. Where it stands and when it passed a
/// multiple follow from the time alone, however late a busy machine lets its thread run. Thread-safe.
class SimulatedTable {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using OnPulse = std::function<void(double position_deg, TimePoint passed)>;

  /// `on_pulse` is called on the table's own thread with where the pulse stands and when it was passed; may be empty.
  SimulatedTable(double pulse_spacing_deg, OnPulse on_pulse);
  ~SimulatedTable();
  SimulatedTable(const SimulatedTable&) = delete;
  SimulatedTable& operator=(const SimulatedTable&) = delete;

  double position_deg() const;
  bool moving() const;
  /// Begins a move over `distance_deg`, after the moves that were begun before.
  void Move(double distance_deg, double speed_deg_s);
  /// Stops at once, at the place reached.
  void Stop();
  /// Sets the position to 0 without a pulse, as homing does.
  void SetZero();
  /// The next pulses are swallowed.
  void SkipPulses(int count) { skipped_pulses_ = count; }

 private:
  struct Pulse {
    double position_deg;
    TimePoint passed;
  };

  void Run();
  double PositionAt(TimePoint now) const;
  /// Advances to `now`; the pulses that it passed on the way wait to be sent.
  void Advance(TimePoint now);

  const double spacing_deg_;
  const OnPulse on_pulse_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  double position_ = 0;  ///< at the time `at_`
  TimePoint at_;
  double target_ = 0, speed_ = 0;
  std::vector<Pulse> pulses_;  ///< not sent yet
  std::atomic<int> skipped_pulses_{0};
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace drupe
