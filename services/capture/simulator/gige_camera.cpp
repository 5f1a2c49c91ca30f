#include "capture/simulator/gige_camera.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

namespace drupe {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::uint16_t kControlPort = 3956;
constexpr std::size_t kFramesKept = 4;
constexpr std::uint32_t kBurstPackets = 16;  // then a pause: half the pace of gigabit Ethernet
constexpr std::chrono::microseconds kBurstPause{500};
constexpr std::size_t kHeaderBytes = 8;
constexpr std::size_t kDiscoveryBytes = 0xF8;
enum Command : std::uint16_t {
  kDiscovery = 0x02,
  kResend = 0x40,
  kReadRegister = 0x80,
  kWriteRegister = 0x82,
  kReadMemory = 0x84,
  kWriteMemory = 0x86
};

sockaddr_in AddressOf(std::uint32_t host_order, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(host_order);
  address.sin_port = htons(port);
  return address;
}

std::uint64_t KeyOf(const sockaddr_in& address) {
  return std::uint64_t{ntohl(address.sin_addr.s_addr)} << 16 | ntohs(address.sin_port);
}

std::uint32_t ParseAddress(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1 ? ntohl(address.s_addr) : 0;
}

}  // namespace

/// A bound UDP socket.
struct GigeCamera::Socket {
  explicit Socket(std::uint32_t address) : fd(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));  // several cameras share the broadcast addresses
    const sockaddr_in name = AddressOf(address, kControlPort);
    bound = bind(fd, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) == 0;
  }
  ~Socket() {
    if (fd >= 0) close(fd);
  }
  Socket(Socket&& other) noexcept : fd(std::exchange(other.fd, -1)), bound(other.bound) {}
  Socket& operator=(Socket&&) = delete;

  int fd;
  bool bound = false;
};

GigeCamera::GigeCamera(const GigeCameraOptions& options, Expose expose)
    : options_(options), expose_(std::move(expose)), random_(options.seed) {}

GigeCamera::~GigeCamera() {
  Unplug();
}

Status GigeCamera::Plug() {
  if (plugged()) return Status::Ok();
  const std::uint32_t address = ParseAddress(options_.address);
  registers_ =
      std::make_unique<CameraRegisters>(options_.serial, options_.sensor_width, options_.sensor_height, address);
  for (const std::uint32_t name : {address, 0xFFFFFFFFU, 0x7FFFFFFFU}) sockets_.emplace_back(name);
  if (!sockets_.front().bound) {
    sockets_.clear();
    return {StatusKind::kUnavailable, "camera_address_taken",
            options_.address + " port 3956 cannot be used; another simulated camera may run there"};
  }
  wake_fd_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  controller_ = 0;
  ending_ = false;
  while (TakePulse()) continue;
  thread_ = std::thread([this] { Run(); });
  return Status::Ok();
}

void GigeCamera::Unplug() {
  if (!plugged()) return;
  ending_ = true;
  eventfd_write(wake_fd_, 1);
  thread_.join();
  close(std::exchange(wake_fd_, -1));
  sockets_.clear();
  sent_.clear();
}

void GigeCamera::PulseLine(double table_deg, SteadyClock::time_point at) {
  {
    const std::lock_guard lock(pulses_mutex_);
    pulses_.push_back({at, table_deg});
    if (pulses_.size() > kFramesKept) pulses_.pop_front();
  }
  if (plugged()) eventfd_write(wake_fd_, 1);
}

std::optional<GigeCamera::Pulse> GigeCamera::TakePulse() {
  const std::lock_guard lock(pulses_mutex_);
  if (pulses_.empty()) return {};
  const Pulse pulse = pulses_.front();
  pulses_.pop_front();
  return pulse;
}

bool GigeCamera::HasPulse() const {
  const std::lock_guard lock(pulses_mutex_);
  return !pulses_.empty();
}

int GigeCamera::PollMs() const {
  if (HasPulse()) return 0;
  if (!registers_->is_streaming() || registers_->is_triggered()) return 100;
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(next_free_shot_ - SteadyClock::now());
  return static_cast<int>(std::clamp<long>(left.count(), 0, 100));
}

void GigeCamera::Run() {
  while (!ending_) {
    std::vector<pollfd> entries = {{wake_fd_, POLLIN, 0}};
    for (const Socket& socket : sockets_) entries.push_back({socket.bound ? socket.fd : -1, POLLIN, 0});
    poll(entries.data(), entries.size(), PollMs());
    eventfd_t count = 0;
    eventfd_read(wake_fd_, &count);
    for (const Socket& socket : sockets_) TakeCommands(socket);
    MindHeartbeat();
    std::optional<Pulse> pulse = TakePulse();
    if (!registers_->waits_for_line()) pulse.reset();
    const bool asked = registers_->TakeSoftwareTrigger();
    const bool free = !registers_->is_triggered() && SteadyClock::now() >= next_free_shot_;
    if (registers_->is_streaming() && (pulse || asked || free)) Shoot(pulse);
  }
}

void GigeCamera::TakeCommands(const Socket& socket) {
  std::array<char, 1024> buffer{};
  sockaddr_in from{};
  socklen_t size = sizeof(from);
  while (socket.bound) {
    const ssize_t count =
        recvfrom(socket.fd, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < static_cast<ssize_t>(kHeaderBytes)) return;
    // A search goes out on every network of the machine; an answer to another would draw the stream there.
    if (ntohl(from.sin_addr.s_addr) >> 24 != 127) continue;
    Answer(std::string_view(buffer.data(), static_cast<std::size_t>(count)), from);
  }
}

/// Only the controller may write, unless there is none.
bool GigeCamera::MayWrite(const sockaddr_in& from) {
  return controller_ == 0 || controller_ == KeyOf(from);
}

void GigeCamera::Answer(std::string_view command, const sockaddr_in& from) {
  const auto code = static_cast<std::uint16_t>(ReadBigEndian(command, 2, 2));
  const std::string_view body = command.substr(kHeaderBytes);
  const auto address = static_cast<std::uint32_t>(ReadBigEndian(body, 0, 4));
  if (KeyOf(from) == controller_) heard_ = SteadyClock::now();
  std::string reply;
  switch (code) {
    case kDiscovery:
      reply = registers_->Read(0, kDiscoveryBytes);
      break;
    case kReadRegister:
      AppendBigEndian(reply, registers_->Get(address), 4);
      break;
    case kReadMemory:
      AppendBigEndian(reply, address, 4);
      reply += registers_->Read(address, ReadBigEndian(body, 4, 4) & 0x3FF);
      break;
    case kWriteRegister:
      if (MayWrite(from)) registers_->Set(address, static_cast<std::uint32_t>(ReadBigEndian(body, 4, 4)));
      AppendBigEndian(reply, 1, 4);
      break;
    case kWriteMemory:
      if (MayWrite(from)) registers_->Write(address, body.substr(std::min<std::size_t>(4, body.size())));
      AppendBigEndian(reply, address, 4);
      break;
    case kResend:
      return Resend(body);
    default:
      return;
  }
  if (controller_ == 0 && registers_->Get(registers::kPrivilege) != 0) {
    controller_ = KeyOf(from);
    heard_ = SteadyClock::now();
  }
  if (registers_->Get(registers::kPrivilege) == 0) controller_ = 0;
  std::string head;
  AppendBigEndian(head, 0, 2);
  AppendBigEndian(head, code + 1U, 2);
  AppendBigEndian(head, reply.size(), 2);
  AppendBigEndian(head, ReadBigEndian(command, 6, 2), 2);
  head += reply;
  sendto(sockets_.front().fd, head.data(), head.size(), 0, reinterpret_cast<const sockaddr*>(&from), sizeof(from));
}

/// A controller that has fallen silent loses its privilege, so that another may take over.
void GigeCamera::MindHeartbeat() {
  const std::chrono::milliseconds patience(registers_->Get(registers::kHeartbeatMs));
  if (controller_ == 0 || SteadyClock::now() - heard_ < patience) return;
  controller_ = 0;
  registers_->Set(registers::kPrivilege, 0);
  registers_->Set(registers::kAcquisition, 0);
}

void GigeCamera::Resend(std::string_view body) {
  const auto block = static_cast<std::uint16_t>(ReadBigEndian(body, 2, 2));
  const auto first = static_cast<std::uint32_t>(ReadBigEndian(body, 4, 4));
  const auto last = static_cast<std::uint32_t>(ReadBigEndian(body, 8, 4));
  for (const GvspFrame& frame : sent_) {
    if (frame.block_id != block) continue;
    for (std::uint32_t i = first; i <= std::min(last, frame.PacketCount() - 1); ++i) {
      ++packets_resent_;
      SendPacket(frame, i);
    }
  }
}

sockaddr_in GigeCamera::StreamAddress() const {
  return AddressOf(registers_->Get(registers::kStreamAddress),
                   static_cast<std::uint16_t>(registers_->Get(registers::kStreamPort)));
}

void GigeCamera::SendPacket(const GvspFrame& frame, std::uint32_t index) {
  if (std::uniform_real_distribution<double>(0, 1)(random_) < loss_) {
    ++packets_lost_;
    return;
  }
  const std::string packet = frame.Packet(index);
  const sockaddr_in to = StreamAddress();
  sendto(sockets_.front().fd, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
}

void GigeCamera::Shoot(const std::optional<Pulse>& pulse) {
  next_free_shot_ =
      SteadyClock::now() + std::chrono::microseconds(std::max(1000U, registers_->Get(registers::kFramePeriodUs)));
  GvspFrame frame;
  frame.window = registers_->Window();
  const int bytes = BytesPerPixel(frame.window.pixel_format);
  if (bytes == 0) return;
  block_id_ = block_id_ == 0xFFFF ? 1 : block_id_ + 1;
  frame.block_id = block_id_;
  const SteadyClock::time_point exposed = pulse ? pulse->at : SteadyClock::now();
  frame.timestamp_ns = CameraClock(exposed);
  frame.packet_bytes = std::max<std::size_t>(576, registers_->Get(registers::kStreamPacketSize) & 0xFFFF);
  frame.pixels.resize(static_cast<std::size_t>(frame.window.width) * frame.window.height * bytes);
  expose_(pulse ? std::optional(pulse->table_deg) : std::nullopt, frame.window, frame.pixels);
  sent_.push_back(std::move(frame));
  if (sent_.size() > kFramesKept) sent_.pop_front();
  const GvspFrame& sending = sent_.back();
  for (std::uint32_t i = 0; i < sending.PacketCount(); ++i) {
    SendPacket(sending, i);
    if (i % kBurstPackets == kBurstPackets - 1) std::this_thread::sleep_for(kBurstPause);
  }
  ++frames_sent_;
}

}  // namespace drupe
