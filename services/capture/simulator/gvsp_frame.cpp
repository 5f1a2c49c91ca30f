#include "capture/simulator/gvsp_frame.h"

#include <algorithm>

namespace drupe {
namespace {

constexpr std::size_t kPacketHeaderBytes = 20 + 8 + 8;  // IP, UDP and GVSP
enum Content : std::uint32_t { kLeader = 1, kTrailer = 2, kPayload = 3 };
constexpr int kImage = 1;

}  // namespace

void AppendBigEndian(std::string& bytes, std::uint64_t value, int count) {
  for (int shift = 8 * (count - 1); shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFF);
}

std::uint64_t ReadBigEndian(std::string_view bytes, std::size_t offset, int count) {
  if (offset + static_cast<std::size_t>(count) > bytes.size()) return 0;
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[offset + i]);
  return value;
}

std::uint32_t GvspFrame::PacketCount() const {
  const std::size_t piece = packet_bytes - kPacketHeaderBytes;
  return static_cast<std::uint32_t>((pixels.size() + piece - 1) / piece + 2);
}

std::string GvspFrame::Packet(std::uint32_t index) const {
  const std::uint32_t last = PacketCount() - 1;
  const Content content = index == 0 ? kLeader : index == last ? kTrailer : kPayload;
  std::string packet;
  AppendBigEndian(packet, 0, 2);
  AppendBigEndian(packet, block_id, 2);
  AppendBigEndian(packet, content << 24 | index, 4);
  if (content == kPayload) {
    const std::size_t piece = packet_bytes - kPacketHeaderBytes, start = (index - 1) * piece;
    const std::size_t size = std::min(piece, pixels.size() - start);
    return packet.append(reinterpret_cast<const char*>(pixels.data()) + start, size);
  }
  AppendBigEndian(packet, kImage, 4);
  if (content == kTrailer) {
    AppendBigEndian(packet, static_cast<std::uint64_t>(window.height), 4);
    return packet;
  }
  AppendBigEndian(packet, timestamp_ns, 8);
  AppendBigEndian(packet, window.pixel_format, 4);
  for (const int value : {window.width, window.height, window.x, window.y, 0}) {
    AppendBigEndian(packet, static_cast<std::uint64_t>(value), 4);
  }
  return packet;
}

}  // namespace drupe
