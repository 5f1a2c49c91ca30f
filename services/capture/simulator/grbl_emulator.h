#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "base/status.h"
#include "capture/simulator/simulated_table.h"

namespace drupe {

/// A GRBL 1.1 controller on a pseudo-terminal, with the axis A on a simulated table. Knows `$X`, `$H`, `$$`, `$I`, G90,
/// G91, G0, G1, G21, F, A, M3 to M9 without effect, and the real-time characters `?`, `!`, `~` and Ctrl-X. It starts
/// locked, as a controller with a reference switch does.
class GrblEmulator {
 public:
  /// `table` must outlive the emulator. Errors: 500 `no_terminal`.
  static Result<std::unique_ptr<GrblEmulator>> Start(SimulatedTable& table);
  ~GrblEmulator();
  GrblEmulator(const GrblEmulator&) = delete;
  GrblEmulator& operator=(const GrblEmulator&) = delete;

  /// The terminal that the driver opens: "/dev/pts/3".
  const std::string& device() const { return device_; }
  /// Fault: a limit switch is hit; the table stops and the controller locks itself ("ALARM:1").
  void RaiseAlarm();
  /// Fault: it hears and says nothing.
  void set_silent(bool silent) { silent_ = silent; }
  /// Fault: the next status report lies about for so long before it is sent.
  void DelayReport(std::chrono::milliseconds delay) { delay_ = delay; }
  /// Status reports sent so far.
  int reports() const { return reports_; }

 private:
  GrblEmulator(SimulatedTable& table, int fd, int own_end, std::string device);
  void Run();
  void Take(char c);
  void Obey(std::string line);
  void Move(std::string_view line);
  void Reset();
  void Say(std::string_view text);
  void SendReport();
  std::string Report() const;

  SimulatedTable& table_;
  const int fd_;       ///< the controller's end
  const int own_end_;  ///< the driver's end, held open so that the terminal outlives drivers that come and go
  const std::string device_;
  std::string line_;
  bool relative_ = false;
  bool rapid_ = false;
  double feed_deg_min_ = 600;
  std::atomic<bool> locked_{true};
  std::atomic<bool> silent_{false};
  std::atomic<std::chrono::milliseconds> delay_{std::chrono::milliseconds(0)};
  std::atomic<int> reports_{0};
  std::atomic<bool> held_{false};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace drupe
