#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <netinet/in.h>

#include "base/status.h"
#include "capture/simulator/camera_registers.h"
#include "capture/simulator/gvsp_frame.h"

namespace drupe {

/// What a simulated camera is.
struct GigeCameraOptions {
  std::string address = "127.0.0.1";  ///< of the loopback network: cameras side by side need one each
  std::string serial = "DRUPE-RIG";
  int sensor_width = 2048;
  int sensor_height = 2048;
  std::uint64_t seed = 1;  ///< of the packets that are lost
};

/// A GigE Vision camera on the loopback network: control protocol (GVCP: discovery, registers, memory, packet resend,
/// heartbeat) and stream protocol (GVSP) as the standard has them, over Aravis's fake camera's registers. Aravis's own
/// ArvGvFakeCamera cannot send a packet again nor be triggered by a line; with 1 % of packets lost it would complete
/// one frame of 660 packets in a thousand.
class GigeCamera {
 public:
  /// Fills `pixels` with what the sensor sees: of the table at `table_deg` when a pulse came with it, else now. Called
  /// on the camera's thread, which may be late for a pulse.
  using Expose =
      std::function<void(std::optional<double> table_deg, const SensorWindow& window, std::span<std::uint8_t> pixels)>;

  GigeCamera(const GigeCameraOptions& options, Expose expose);
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;

  /// Connects it to the network with its registers as after power-on. Errors: 503 `camera_address_taken`.
  Status Plug();
  /// Cuts it off at once.
  void Unplug();
  bool plugged() const { return thread_.joinable(); }

  /// A rising edge on Line1 at the instant `at`, which exposed what was seen then: the table at `table_deg`.
  void PulseLine(double table_deg, std::chrono::steady_clock::time_point at);
  /// Fault: this share of the stream's packets is lost, 0..1; of those sent again too.
  void set_loss(double share) { loss_ = share; }

  std::int64_t frames_sent() const { return frames_sent_; }
  std::int64_t packets_lost() const { return packets_lost_; }
  std::int64_t packets_resent() const { return packets_resent_; }

 private:
  struct Socket;
  struct Pulse {
    std::chrono::steady_clock::time_point at;
    double table_deg = 0;
  };

  void Run();
  int PollMs() const;
  void TakeCommands(const Socket& socket);
  void Answer(std::string_view command, const sockaddr_in& from);
  bool MayWrite(const sockaddr_in& from);
  void Resend(std::string_view body);
  void MindHeartbeat();
  std::optional<Pulse> TakePulse();
  bool HasPulse() const;
  void Shoot(const std::optional<Pulse>& pulse);
  void SendPacket(const GvspFrame& frame, std::uint32_t index);
  sockaddr_in StreamAddress() const;

  const GigeCameraOptions options_;
  const Expose expose_;
  std::unique_ptr<CameraRegisters> registers_;
  std::vector<Socket> sockets_;  ///< own address first, then the broadcasts
  int wake_fd_ = -1;
  std::atomic<bool> ending_{false};
  mutable std::mutex pulses_mutex_;
  std::deque<Pulse> pulses_;  ///< not exposed yet
  std::atomic<double> loss_{0};
  std::mt19937_64 random_;
  std::uint64_t controller_ = 0;  ///< address and port; 0: nobody
  std::chrono::steady_clock::time_point heard_, next_free_shot_;
  std::uint16_t block_id_ = 0;
  std::deque<GvspFrame> sent_;  ///< the latest, for resends
  std::atomic<std::int64_t> frames_sent_{0}, packets_lost_{0}, packets_resent_{0};
  std::thread thread_;
};

}  // namespace drupe
