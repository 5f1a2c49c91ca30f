#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "reconstruction/dense/patch_map.h"

namespace drupe::dense {

constexpr std::size_t kMaxCells = std::size_t{1} << 28;  ///< of a map that is read
constexpr std::size_t kPlacedCellBytes = 32;             ///< of a cell with its place

/// Appends the filled cells of a map with their places, as they lie in memory; only those with a flag in `keep` unless
/// it is empty. Returns how many.
std::size_t AppendCells(const PatchMap& map, const std::vector<std::uint8_t>& keep, std::string* bytes);

/// Takes `count` cells off the front of `bytes` into `map`, whose size is known. Errors: 422 `bad_part`.
Status TakeCells(std::size_t count, std::string_view* bytes, PatchMap* map);

/// Appends the places of the flags that are set; returns how many. TakeFlags takes them back. Errors: 422 `bad_part`.
std::size_t AppendFlags(const std::vector<std::uint8_t>& flags, std::string* bytes);
Status TakeFlags(std::size_t count, std::string_view* bytes, std::vector<std::uint8_t>* flags);

/// The line of JSON at the front of `bytes`, which it is taken off. Errors: 422 `bad_part`, 400 as ParseJson.
Result<Json> TakeHead(std::string_view* bytes);

/// 422 `bad_part`.
Status BadPart(const std::string& why);

}  // namespace drupe::dense
