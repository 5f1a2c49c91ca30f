#include "capture/simulator/camera_registers.h"

#include <arv.h>

#include <algorithm>

#include "capture/simulator/gvsp_frame.h"

namespace drupe {
namespace {

constexpr std::uint32_t kPacketResend = 1U << 2;
constexpr std::uint32_t kCanWriteMemory = 1U << 1;
constexpr std::uint32_t kLatch = 2;  // of kClockControl
constexpr std::uint32_t kNanosecondsHz = 1'000'000'000;
constexpr std::chrono::nanoseconds kAhead{7'654'321'000};  // of our clock: a camera has its own zero

void Rename(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) text.replace(at, 5, to);
}

/// Aravis's description; names of equal length keep its size.
std::string Description(ArvFakeCamera* camera) {
  std::size_t size = 0;
  const char* xml = arv_fake_camera_get_genicam_xml(camera, &size);
  std::string text(xml, size);
  Rename(text, "Line0", "Line1");
  return text;
}

}  // namespace

std::uint64_t CameraClock(std::chrono::steady_clock::time_point at) {
  return static_cast<std::uint64_t>((at.time_since_epoch() + kAhead).count());
}

CameraRegisters::CameraRegisters(const std::string& serial, int sensor_width, int sensor_height,
                                 std::uint32_t ip_address) {
  ArvFakeCamera* camera = arv_fake_camera_new(serial.c_str());
  memory_.resize(ARV_FAKE_CAMERA_MEMORY_SIZE);
  arv_fake_camera_read_memory(camera, 0, ARV_FAKE_CAMERA_MEMORY_SIZE, memory_.data());
  memory_ += Description(camera);
  g_object_unref(camera);
  Set(registers::kSensorWidth, static_cast<std::uint32_t>(sensor_width));
  Set(registers::kSensorHeight, static_cast<std::uint32_t>(sensor_height));
  Set(registers::kWidth, static_cast<std::uint32_t>(sensor_width));
  Set(registers::kHeight, static_cast<std::uint32_t>(sensor_height));
  Set(registers::kCapabilities, kPacketResend | kCanWriteMemory);
  Set(registers::kCurrentAddress, ip_address);
  Set(registers::kClockHz, 0);
  Set(registers::kClockHz + 4, kNanosecondsHz);
}

std::uint32_t CameraRegisters::Get(std::uint32_t address) const {
  return static_cast<std::uint32_t>(ReadBigEndian(memory_, address, 4));
}

void CameraRegisters::Set(std::uint32_t address, std::uint32_t value) {
  std::string bytes;
  AppendBigEndian(bytes, value, 4);
  Write(address, bytes);
}

std::string CameraRegisters::Read(std::uint32_t address, std::size_t size) const {
  std::string bytes = address < memory_.size() ? memory_.substr(address, size) : std::string();
  bytes.resize(size, '\0');
  return bytes;
}

void CameraRegisters::Write(std::uint32_t address, std::string_view bytes) {
  if (address + bytes.size() > ARV_FAKE_CAMERA_MEMORY_SIZE) return;
  std::copy(bytes.begin(), bytes.end(), memory_.begin() + address);
  if (address != registers::kClockControl || Get(address) != kLatch) return;
  std::string clock;
  AppendBigEndian(clock, CameraClock(std::chrono::steady_clock::now()), 8);
  std::copy(clock.begin(), clock.end(), memory_.begin() + registers::kLatchedClock);
}

SensorWindow CameraRegisters::Window() const {
  const auto within = [](std::uint32_t value, std::uint32_t high) { return static_cast<int>(std::min(value, high)); };
  const std::uint32_t width = Get(registers::kSensorWidth), height = Get(registers::kSensorHeight);
  SensorWindow window;
  window.x = within(Get(registers::kOffsetX), width - 1);
  window.y = within(Get(registers::kOffsetY), height - 1);
  window.width = within(Get(registers::kWidth), width - static_cast<std::uint32_t>(window.x));
  window.height = within(Get(registers::kHeight), height - static_cast<std::uint32_t>(window.y));
  window.pixel_format = Get(registers::kPixelFormat);
  return window;
}

bool CameraRegisters::TakeSoftwareTrigger() {
  const bool due = Get(registers::kTriggerSoftware) == 1;
  if (due) Set(registers::kTriggerSoftware, 0);
  return due && is_triggered() && Get(registers::kTriggerSource) == 1;
}

}  // namespace drupe
