#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace drupe {

/// One image file directory of a TIFF structure, which is also what EXIF is (TIFF 6.0, section 2). Reads numbers out of
/// untrusted bytes: every offset is checked, nothing is allocated and the work is one pass over the entries. The bytes
/// must outlive the directory.
class TiffDirectory {
 public:
  /// The first directory of `tiff`, which starts with "II*\0" or "MM\0*"; nothing when it is malformed.
  static std::optional<TiffDirectory> First(std::string_view tiff);

  /// The first value of a tag of type BYTE, SHORT, LONG or RATIONAL; nothing when it is absent, of another type,
  /// outside the bytes, or a division by zero.
  std::optional<double> Number(std::uint16_t tag) const;

  /// The directory that a tag points to (tag 0x8769 leads to EXIF).
  std::optional<TiffDirectory> Directory(std::uint16_t tag) const;

 private:
  TiffDirectory(std::string_view tiff, bool big_endian) : tiff_(tiff), big_endian_(big_endian) {}

  std::optional<TiffDirectory> At(std::uint32_t offset) const;
  bool Holds(std::uint64_t offset, std::uint64_t length) const;
  std::uint16_t Read16(std::uint64_t offset) const;
  std::uint32_t Read32(std::uint64_t offset) const;

  std::string_view tiff_;
  bool big_endian_ = false;
  std::uint64_t first_entry_ = 0;
  int entry_count_ = 0;
};

}  // namespace drupe
