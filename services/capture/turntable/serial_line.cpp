#include "capture/turntable/serial_line.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <map>

namespace drupe {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr std::size_t kMaxLineBytes = 512;

Status Unreachable(const std::string& device, std::string_view why) {
  return {StatusKind::kUnavailable, "table_unreachable", "the turntable at " + device + ": " + std::string(why)};
}

Result<speed_t> SpeedOf(int baud) {
  static const std::map<int, speed_t> kSpeeds = {{9600, B9600},   {19200, B19200},   {38400, B38400},
                                                 {57600, B57600}, {115200, B115200}, {230400, B230400}};
  const auto speed = kSpeeds.find(baud);
  if (speed != kSpeeds.end()) return speed->second;
  return InvalidArgument("invalid_option", "a serial line cannot have " + std::to_string(baud) + " baud", "baud");
}

bool MakeRaw(int fd, speed_t speed) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) return false;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~HUPCL;  // closing must not reset a controller that is reset by DTR
  return cfsetspeed(&settings, speed) == 0 && tcsetattr(fd, TCSANOW, &settings) == 0;
}

}  // namespace

Result<std::unique_ptr<SerialLine>> SerialLine::Open(const std::string& device, int baud) {
  DRUPE_ASSIGN_OR_RETURN(const speed_t speed, SpeedOf(baud));
  const int fd = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return Unreachable(device, std::strerror(errno));
  std::unique_ptr<SerialLine> line(new SerialLine(fd, device));
  if (!MakeRaw(fd, speed)) return line->Fail("settings");
  if (ioctl(fd, TIOCEXCL) != 0) return line->Fail("lock");
  return line;
}

SerialLine::~SerialLine() {
  ioctl(fd_, TIOCNXCL);
  close(fd_);
}

Status SerialLine::Fail(std::string_view operation) const {
  return Unreachable(device_, std::string(operation) + " failed (" + std::strerror(errno) + ")");
}

Status SerialLine::Write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(fd_, text.data(), text.size());
    if (count < 0 && errno != EAGAIN && errno != EINTR) return Fail("write");
    if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    if (text.empty()) break;
    pollfd entry{fd_, POLLOUT, 0};
    if (poll(&entry, 1, 1000) == 0) return Unreachable(device_, "it takes no commands");
  }
  return Status::Ok();
}

std::optional<std::string> SerialLine::TakeLine() {
  while (true) {
    const std::size_t end = received_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    std::string line = received_.substr(0, std::min(end, kMaxLineBytes));
    received_.erase(0, end + 1);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty()) return line;
  }
}

Result<bool> SerialLine::Receive(SteadyClock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - SteadyClock::now()).count();
  pollfd entry{fd_, POLLIN, 0};
  const int ready = poll(&entry, 1, static_cast<int>(std::clamp<long>(left, 0, 60'000)));
  if (ready < 0 && errno != EINTR) return Fail("wait");
  if (ready <= 0) return false;
  std::array<char, 256> buffer{};
  const ssize_t count = read(fd_, buffer.data(), buffer.size());
  if (count == 0) return Unreachable(device_, "the line was closed");
  if (count < 0) return errno == EAGAIN || errno == EINTR ? Result<bool>(true) : Result<bool>(Fail("read"));
  received_.append(buffer.data(), static_cast<std::size_t>(count));
  if (received_.size() > 16 * kMaxLineBytes && received_.find('\n') == std::string::npos) received_.clear();
  return true;
}

Result<std::optional<std::string>> SerialLine::ReadLine(std::chrono::milliseconds timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  while (true) {
    if (std::optional<std::string> line = TakeLine()) return line;
    DRUPE_ASSIGN_OR_RETURN(const bool more, Receive(deadline));
    if (!more && SteadyClock::now() >= deadline) return std::optional<std::string>();
  }
}

void SerialLine::Discard() {
  tcflush(fd_, TCIFLUSH);
  received_.clear();
}

}  // namespace drupe
