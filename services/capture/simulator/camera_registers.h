#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "capture/simulator/picture_turn.h"

namespace drupe {

/// Addresses of the registers that the simulated camera acts on: GigE Vision's bootstrap registers, and those of the
/// description that Aravis ships for its fake camera.
namespace registers {
inline constexpr std::uint32_t kCurrentAddress = 0x24, kCapabilities = 0x934, kHeartbeatMs = 0x938;
inline constexpr std::uint32_t kClockHz = 0x93C, kClockControl = 0x944, kLatchedClock = 0x948;
inline constexpr std::uint32_t kPrivilege = 0xA00;
inline constexpr std::uint32_t kStreamPort = 0xD00, kStreamPacketSize = 0xD04, kStreamAddress = 0xD18;
inline constexpr std::uint32_t kWidth = 0x100, kHeight = 0x104, kSensorHeight = 0x118, kSensorWidth = 0x11C;
inline constexpr std::uint32_t kExposureUs = 0x120, kAcquisition = 0x124, kPixelFormat = 0x128;
inline constexpr std::uint32_t kOffsetX = 0x130, kOffsetY = 0x134, kFramePeriodUs = 0x138;
inline constexpr std::uint32_t kTriggerMode = 0x300, kTriggerSource = 0x304, kTriggerSoftware = 0x30C;
}  // namespace registers

/// What the camera's own clock, in nanoseconds, shows at an instant of ours.
std::uint64_t CameraClock(std::chrono::steady_clock::time_point at);

/// The memory that a GigE Vision camera shows to its controller: registers, and its description in XML. Initialised
/// from Aravis's fake camera, with what that lacks: a sensor of any size, packet resend, a clock that can be read, and
/// the trigger input called Line1.
class CameraRegisters {
 public:
  CameraRegisters(const std::string& serial, int sensor_width, int sensor_height, std::uint32_t ip_address);

  std::uint32_t Get(std::uint32_t address) const;
  void Set(std::uint32_t address, std::uint32_t value);
  /// Bytes beyond the end read as 0.
  std::string Read(std::uint32_t address, std::size_t size) const;
  /// Ignored beyond the registers: the description cannot be written. Notes the clock when it is asked to.
  void Write(std::uint32_t address, std::string_view bytes);

  /// The window of the sensor that is asked for, cut to the sensor.
  SensorWindow Window() const;
  bool is_streaming() const { return Get(registers::kPrivilege) != 0 && Get(registers::kAcquisition) != 0; }
  bool is_triggered() const { return Get(registers::kTriggerMode) == 1; }
  bool waits_for_line() const { return is_triggered() && Get(registers::kTriggerSource) == 0; }
  /// Whether a software trigger has come since the last call.
  bool TakeSoftwareTrigger();

 private:
  std::string memory_;
};

}  // namespace drupe
