#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace drupe {

/// The mechanics of a simulated turntable: one axis in degrees, moved at constant speed, which sends a pulse whenever
/// it passes a multiple of the pulse spacing, as the encoder of a real one does. Thread-safe.
class SimulatedTable {
 public:
  /// `on_pulse` is called on the table's own thread with where the pulse stands; may be empty.
  SimulatedTable(double pulse_spacing_deg, std::function<void(double position_deg)> on_pulse);
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
  void Run();
  /// Advances by one tick; returns where it passed pulses on the way.
  std::vector<double> Step(double seconds);

  const double spacing_deg_;
  const std::function<void(double position_deg)> on_pulse_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  double position_ = 0, target_ = 0, speed_ = 0;
  std::atomic<int> skipped_pulses_{0};
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace drupe
