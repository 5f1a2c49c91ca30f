#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "base/status.h"
#include "store/file_system.h"

namespace drupe {

/// How the files of a store lie in its directory: objects in ab/abcdef..., beside them these.
inline constexpr std::string_view kTemporaryFolder = "tmp";
inline constexpr std::string_view kUploadFolder = "uploads";  ///< unfinished, named by the digest to come
inline constexpr std::string_view kRootsFolder = "roots";     ///< what the services refer to, a file each
/// Held shared while a file becomes an object, and alone while one is looked at once more and removed, so that an
/// object which is stored again in that moment is not lost.
inline constexpr std::string_view kCollectionLock = "collection.lock";

/// Calls `visit` with the folder and the name of every file below the fan-out folders, in the order of their names.
Status ForEachFile(const std::filesystem::path& directory, FileSystem& files,
                   const std::function<Status(const std::string&, const std::string&)>& visit);

/// The objects of a store by their digests, without what is no object. One that vanishes meanwhile is left out.
Result<std::map<std::string, FileInfo>> ListObjects(const std::filesystem::path& directory, FileSystem& files);

/// Calls `take` with the file's bytes, piece by piece.
Status ReadAll(const ReadableFile& file, const std::function<void(std::string_view)>& take);

/// The SHA-256 of a file's bytes.
Result<std::string> DigestOf(const ReadableFile& file);

}  // namespace drupe
