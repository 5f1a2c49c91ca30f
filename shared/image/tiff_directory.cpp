#include "image/tiff_directory.h"

namespace drupe {
namespace {

constexpr int kEntryBytes = 12;

enum TiffType : std::uint16_t { kByte = 1, kShort = 3, kLong = 4, kRational = 5 };

std::uint32_t ByteAt(std::string_view bytes, std::uint64_t offset) {
  return static_cast<unsigned char>(bytes[offset]);
}

}  // namespace

bool TiffDirectory::Holds(std::uint64_t offset, std::uint64_t length) const {
  return offset <= tiff_.size() && length <= tiff_.size() - offset;
}

std::uint16_t TiffDirectory::Read16(std::uint64_t offset) const {
  const std::uint32_t first = ByteAt(tiff_, offset), second = ByteAt(tiff_, offset + 1);
  return static_cast<std::uint16_t>(big_endian_ ? first << 8 | second : second << 8 | first);
}

std::uint32_t TiffDirectory::Read32(std::uint64_t offset) const {
  const std::uint32_t first = Read16(offset), second = Read16(offset + 2);
  return big_endian_ ? first << 16 | second : second << 16 | first;
}

std::optional<TiffDirectory> TiffDirectory::First(std::string_view tiff) {
  if (tiff.size() < 8) return std::nullopt;
  const bool big_endian = tiff[0] == 'M';
  if (!(tiff.starts_with("II") || tiff.starts_with("MM"))) return std::nullopt;
  const TiffDirectory header(tiff, big_endian);
  if (header.Read16(2) != 42) return std::nullopt;
  return header.At(header.Read32(4));
}

std::optional<TiffDirectory> TiffDirectory::At(std::uint32_t offset) const {
  if (!Holds(offset, 2)) return std::nullopt;
  TiffDirectory directory(tiff_, big_endian_);
  directory.first_entry_ = std::uint64_t{offset} + 2;
  directory.entry_count_ = Read16(offset);
  if (!Holds(directory.first_entry_, std::uint64_t{kEntryBytes} * directory.entry_count_)) return std::nullopt;
  return directory;
}

std::optional<double> TiffDirectory::Number(std::uint16_t tag) const {
  for (int i = 0; i < entry_count_; ++i) {
    const std::uint64_t entry = first_entry_ + std::uint64_t{kEntryBytes} * i;
    if (Read16(entry) != tag) continue;
    if (Read32(entry + 4) == 0) return std::nullopt;
    switch (Read16(entry + 2)) {
      case kByte:
        return ByteAt(tiff_, entry + 8);
      case kShort:
        return Read16(entry + 8);
      case kLong:
        return Read32(entry + 8);
      case kRational: {
        const std::uint64_t at = Read32(entry + 8);
        if (!Holds(at, 8) || Read32(at + 4) == 0) return std::nullopt;
        return static_cast<double>(Read32(at)) / Read32(at + 4);
      }
      default:
        return std::nullopt;
    }
  }
  return std::nullopt;
}

std::optional<TiffDirectory> TiffDirectory::Directory(std::uint16_t tag) const {
  const std::optional<double> offset = Number(tag);
  return offset ? At(static_cast<std::uint32_t>(*offset)) : std::nullopt;
}

}  // namespace drupe
