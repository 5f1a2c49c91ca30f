#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capture/simulator/picture_turn.h"

namespace drupe {

/// One picture as the packets of the GigE Vision stream protocol (GVSP 1.x, 16-bit block ids): packet 0 is the leader,
/// the last one the trailer. Kept for a while, so that lost packets can be sent again.
struct GvspFrame {
  std::uint16_t block_id = 0;
  std::uint64_t timestamp_ns = 0;
  SensorWindow window;
  std::size_t packet_bytes = 1400;  ///< of a whole IP datagram, as the register GevSCPSPacketSize counts
  std::vector<std::uint8_t> pixels;

  std::uint32_t PacketCount() const;
  /// The bytes of packet `index` < PacketCount().
  std::string Packet(std::uint32_t index) const;
};

/// Appends a number, most significant byte first, as GigE Vision has it everywhere.
void AppendBigEndian(std::string& bytes, std::uint64_t value, int count);
/// Reads `count` bytes at `offset`; 0 beyond the end.
std::uint64_t ReadBigEndian(std::string_view bytes, std::size_t offset, int count);

}  // namespace drupe
