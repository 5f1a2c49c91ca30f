#include "capture/simulator/grbl_emulator.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace drupe {
namespace {

constexpr double kRapidDegPerSecond = 180;
constexpr std::size_t kMaxLine = 80;  // GRBL's own limit

Status NoTerminal(int fd) {
  if (fd >= 0) close(fd);
  return Internal("no_terminal", "a pseudo-terminal cannot be opened");
}

}  // namespace

Result<std::unique_ptr<GrblEmulator>> GrblEmulator::Start(SimulatedTable& table) {
  const int fd = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::array<char, 64> name{};
  if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0 || ptsname_r(fd, name.data(), name.size()) != 0) {
    return NoTerminal(fd);
  }
  const int own_end = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (own_end < 0 || tcgetattr(own_end, &settings) != 0) return NoTerminal(fd);
  cfmakeraw(&settings);
  tcsetattr(own_end, TCSANOW, &settings);
  return std::unique_ptr<GrblEmulator>(new GrblEmulator(table, fd, own_end, name.data()));
}

GrblEmulator::GrblEmulator(SimulatedTable& table, int fd, int own_end, std::string device)
    : table_(table), fd_(fd), own_end_(own_end), device_(std::move(device)), thread_([this] { Run(); }) {}

GrblEmulator::~GrblEmulator() {
  ending_ = true;
  thread_.join();
  close(own_end_);
  close(fd_);
}

void GrblEmulator::RaiseAlarm() {
  table_.Stop();
  locked_ = true;  // at once, not when the thread comes to it: whoever asks from now on is told so
  Say("ALARM:1\r\n[MSG:Reset to continue]\r\n");
}

void GrblEmulator::Run() {
  std::array<char, 128> buffer{};
  while (!ending_) {
    pollfd entry{fd_, POLLIN, 0};
    if (poll(&entry, 1, 10) <= 0 || (entry.revents & POLLIN) == 0) continue;
    const ssize_t count = read(fd_, buffer.data(), buffer.size());
    for (ssize_t i = 0; i < count; ++i) Take(buffer[static_cast<std::size_t>(i)]);
  }
}

void GrblEmulator::Take(char c) {
  switch (c) {
    case '?':
      return SendReport();
    case '!':
      held_ = table_.moving();
      return table_.Stop();
    case '~':
      held_ = false;
      return;
    case '\x18':
      return Reset();
    case '\r':
    case '\n':
      Obey(std::move(line_));
      line_.clear();
      return;
    default:
      if (line_.size() < kMaxLine && c > ' ') line_ += c;
  }
}

/// A reset while the axis moves loses the position, which GRBL reports as alarm 3.
void GrblEmulator::Reset() {
  const bool lost = table_.moving();
  table_.Stop();
  held_ = false;
  line_.clear();
  relative_ = false;
  if (lost) {
    locked_ = true;
    Say("ALARM:3\r\n");
  }
  Say("\r\nGrbl 1.1h ['$' for help]\r\n");
  if (locked_) Say("[MSG:'$H'|'$X' to unlock]\r\n");
}

void GrblEmulator::Obey(std::string line) {
  if (line.empty()) return;
  if (line == "$X" || line == "$H") {
    if (line == "$H") table_.SetZero();
    locked_ = false;
    return Say("ok\r\n");
  }
  if (line == "$$" || line == "$I") return Say("[VER:1.1h.simulated:]\r\nok\r\n");
  if (line.front() == '$') return Say("error:3\r\n");
  if (locked_) return Say("error:9\r\n");
  Move(line);
}

/// The words of a line of G-code: a letter and a number each.
void GrblEmulator::Move(std::string_view line) {
  const std::string text(line);
  bool has_target = false;
  double target = 0;
  for (const char* position = text.c_str(); *position != '\0';) {
    const char letter = *position++;
    char* end = nullptr;
    const double number = std::strtod(position, &end);
    if (end == position) return Say("error:2\r\n");
    position = end;
    if (letter == 'G' && (number == 0 || number == 1)) rapid_ = number == 0;
    if (letter == 'G' && (number == 90 || number == 91)) relative_ = number == 91;
    if (letter == 'F') feed_deg_min_ = number;
    if (letter == 'A') has_target = true, target = number;
    if (std::string_view("GFAMSTN").find(letter) == std::string_view::npos) return Say("error:20\r\n");
  }
  if (has_target && !held_) {
    const double distance = relative_ ? target : target - table_.position_deg();
    table_.Move(distance, rapid_ ? kRapidDegPerSecond : feed_deg_min_ / 60);
  }
  Say("ok\r\n");
}

void GrblEmulator::Say(std::string_view text) {
  if (silent_) return;
  const ssize_t ignored = write(fd_, text.data(), text.size());
  (void)ignored;  // a driver that does not read loses lines, as on a real line
}

void GrblEmulator::SendReport() {
  const std::string report = Report();
  std::this_thread::sleep_for(delay_.exchange(std::chrono::milliseconds(0)));
  ++reports_;
  Say(report);
}

std::string GrblEmulator::Report() const {
  const char* state = locked_ ? "Alarm" : held_ ? "Hold:0" : table_.moving() ? "Run" : "Idle";
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "<%s|MPos:0.000,0.000,0.000,%.3f|FS:%.0f,0>\r\n", state,
                table_.position_deg(), table_.moving() ? feed_deg_min_ : 0);
  return text.data();
}

}  // namespace drupe
