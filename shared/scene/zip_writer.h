#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"

namespace drupe {

/// One file of an archive.
struct ZipEntry {
  std::string name;  ///< path inside the archive, '/' between folders
  std::string content;
};

/// A zip archive (PKWARE APPNOTE 6.3.3) whose files are stored, not compressed, all dated 1980-01-01 so that equal
/// content gives equal bytes. Errors: 500 `zip_too_large` from 4 GB or 65,535 files on, which would need zip64.
Result<std::string> WriteZip(const std::vector<ZipEntry>& entries);

/// CRC-32 as zip and PNG use it (polynomial 0xEDB88320, reflected).
std::uint32_t Crc32(std::string_view bytes);

}  // namespace drupe
