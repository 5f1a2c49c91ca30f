#include "reconstruction/dense/packed_cells.h"

#include <bit>
#include <cstring>

namespace drupe::dense {

namespace {

constexpr JsonLimits kHeadLimits{.max_bytes = 16 << 20, .max_depth = 8};

/// A cell and its place in PatchMap::cells.
struct PlacedCell {
  std::uint32_t place = 0;
  PatchCell cell;
};
static_assert(std::endian::native == std::endian::little && sizeof(PlacedCell) == kPlacedCellBytes,
              "written as memory lies");

template <typename T>
void AppendValue(const T& value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// Calls take(value) for `count` values at the front of `bytes`.
template <typename T, typename Take>
Status TakeValues(std::size_t count, std::string_view* bytes, const Take& take) {
  if (count > bytes->size() / sizeof(T)) return BadPart("it is cut off");
  for (std::size_t k = 0; k < count; ++k) {
    T value;
    std::memcpy(&value, bytes->data() + k * sizeof(T), sizeof(T));
    DRUPE_RETURN_IF_ERROR(take(value));
  }
  bytes->remove_prefix(count * sizeof(T));
  return Status::Ok();
}

}  // namespace

Status BadPart(const std::string& why) {
  return Unprocessable("bad_part", "the part of a reconstruction cannot be read: " + why);
}

std::size_t AppendCells(const PatchMap& map, const std::vector<std::uint8_t>& keep, std::string* bytes) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < map.cells.size(); ++k) {
    if (!map.cells[k].Filled() || (!keep.empty() && !keep[k])) continue;
    AppendValue(PlacedCell{static_cast<std::uint32_t>(k), map.cells[k]}, bytes);
    ++count;
  }
  return count;
}

Status TakeCells(std::size_t count, std::string_view* bytes, PatchMap* map) {
  return TakeValues<PlacedCell>(count, bytes, [&](const PlacedCell& placed) {
    if (placed.place >= map->cells.size()) return BadPart("a cell lies outside its map");
    map->cells[placed.place] = placed.cell;
    return Status::Ok();
  });
}

std::size_t AppendFlags(const std::vector<std::uint8_t>& flags, std::string* bytes) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < flags.size(); ++k) {
    if (!flags[k]) continue;
    AppendValue(static_cast<std::uint32_t>(k), bytes);
    ++count;
  }
  return count;
}

Status TakeFlags(std::size_t count, std::string_view* bytes, std::vector<std::uint8_t>* flags) {
  return TakeValues<std::uint32_t>(count, bytes, [&](std::uint32_t place) {
    if (place >= flags->size()) return BadPart("a flag lies outside its map");
    (*flags)[place] = 1;
    return Status::Ok();
  });
}

Result<Json> TakeHead(std::string_view* bytes) {
  const std::size_t end = bytes->find('\n');
  if (end == std::string_view::npos) return BadPart("it has no head");
  Result<Json> head = ParseJson(bytes->substr(0, end), kHeadLimits);
  bytes->remove_prefix(end + 1);
  return head;
}

}  // namespace drupe::dense
