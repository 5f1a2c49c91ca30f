#include "scene/zip_writer.h"

#include <array>

namespace drupe {
namespace {

constexpr std::uint16_t kVersion = 20;             // needed to extract: 2.0
constexpr std::uint16_t kFirstDay = (1 << 5) | 1;  // MS-DOS date of 1980-01-01

void Append16(std::string& out, std::uint32_t value) {
  out.push_back(static_cast<char>(value & 0xff));
  out.push_back(static_cast<char>((value >> 8) & 0xff));
}

void Append32(std::string& out, std::uint32_t value) {
  Append16(out, value & 0xffff);
  Append16(out, value >> 16);
}

std::array<std::uint32_t, 256> MakeCrcTable() {
  std::array<std::uint32_t, 256> table;
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
    table[byte] = crc;
  }
  return table;
}

/// What the local header and the central directory say alike: version to lengths of name and extra field.
std::string CommonHeader(const ZipEntry& entry) {
  const auto size = static_cast<std::uint32_t>(entry.content.size());
  std::string header;
  Append16(header, kVersion);
  Append16(header, 0);  // flags
  Append16(header, 0);  // stored
  Append16(header, 0);  // midnight
  Append16(header, kFirstDay);
  Append32(header, Crc32(entry.content));
  Append32(header, size);
  Append32(header, size);
  Append16(header, static_cast<std::uint32_t>(entry.name.size()));
  Append16(header, 0);  // no extra field
  return header;
}

void AppendDirectoryEntry(const ZipEntry& entry, const std::string& common, std::uint32_t offset,
                          std::string& directory) {
  Append32(directory, 0x02014b50);
  Append16(directory, kVersion);  // made by
  directory += common;
  Append16(directory, 0);  // no comment
  Append16(directory, 0);  // disk
  Append16(directory, 0);  // internal attributes
  Append32(directory, 0);  // external attributes
  Append32(directory, offset);
  directory += entry.name;
}

bool Fits(const std::vector<ZipEntry>& entries) {
  std::uint64_t total = 0;
  constexpr std::uint64_t kHeaders = 30 + 46 + 22;
  for (const ZipEntry& entry : entries) total += entry.content.size() + 2 * entry.name.size() + kHeaders;
  return total < 0xffffffffULL && entries.size() < 0xffff;
}

}  // namespace

std::uint32_t Crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = MakeCrcTable();
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) crc = table[(crc ^ static_cast<unsigned char>(byte)) & 0xff] ^ (crc >> 8);
  return crc ^ 0xffffffffu;
}

Result<std::string> WriteZip(const std::vector<ZipEntry>& entries) {
  if (!Fits(entries)) return Internal("zip_too_large", "the archive would exceed 4 GB or 65,535 files");
  std::string archive, directory;
  for (const ZipEntry& entry : entries) {
    const auto offset = static_cast<std::uint32_t>(archive.size());
    const std::string common = CommonHeader(entry);
    Append32(archive, 0x04034b50);
    archive += common;
    archive += entry.name;
    archive += entry.content;
    AppendDirectoryEntry(entry, common, offset, directory);
  }
  const auto directory_offset = static_cast<std::uint32_t>(archive.size());
  archive += directory;
  Append32(archive, 0x06054b50);
  Append16(archive, 0);  // this disk
  Append16(archive, 0);  // disk of the directory
  Append16(archive, static_cast<std::uint32_t>(entries.size()));
  Append16(archive, static_cast<std::uint32_t>(entries.size()));
  Append32(archive, static_cast<std::uint32_t>(directory.size()));
  Append32(archive, directory_offset);
  Append16(archive, 0);  // no comment
  return archive;
}

}  // namespace drupe
