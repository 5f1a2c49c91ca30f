#include "scene/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "scene/ply_values.h"

namespace drupe {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as memory lies");

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct TypeName {
  std::string_view name;
  Type type;
  std::size_t size;
};
constexpr std::array<TypeName, 16> kTypes = {{{"char", Type::kInt8, 1},
                                              {"int8", Type::kInt8, 1},
                                              {"uchar", Type::kUint8, 1},
                                              {"uint8", Type::kUint8, 1},
                                              {"short", Type::kInt16, 2},
                                              {"int16", Type::kInt16, 2},
                                              {"ushort", Type::kUint16, 2},
                                              {"uint16", Type::kUint16, 2},
                                              {"int", Type::kInt32, 4},
                                              {"int32", Type::kInt32, 4},
                                              {"uint", Type::kUint32, 4},
                                              {"uint32", Type::kUint32, 4},
                                              {"float", Type::kFloat, 4},
                                              {"float32", Type::kFloat, 4},
                                              {"double", Type::kDouble, 8},
                                              {"float64", Type::kDouble, 8}}};

struct Property {
  std::string name;
  Type type = Type::kFloat;
  std::size_t offset = 0;
};

struct Header {
  std::int64_t count = 0;
  std::vector<Property> properties;
  std::size_t vertex_bytes = 0;
  std::size_t data_begin = 0;
};

Status BadPly(const std::string& what) {
  return Unprocessable("bad_ply", "not a usable PLY file: " + what);
}

/// Splits at blanks.
std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

/// Reads the header line by line.
class HeaderParser {
 public:
  explicit HeaderParser(const PlyLimits& limits) : limits_(limits) {}

  Result<Header> Parse(std::string_view bytes) {
    if (bytes.substr(0, 4) != "ply\n" && bytes.substr(0, 5) != "ply\r\n") return BadPly("it does not start with ply");
    const std::string_view text = bytes.substr(0, limits_.max_header_bytes);
    std::size_t position = text.find('\n') + 1;
    while (true) {
      const std::size_t end = text.find('\n', position);
      if (end == std::string_view::npos) return BadPly("the header does not end");
      const auto words = Words(text.substr(position, end - position));
      position = end + 1;
      if (!words.empty() && words[0] == "end_header") break;
      DRUPE_RETURN_IF_ERROR(ParseLine(words));
    }
    if (!has_format_) return BadPly("the header names no format");
    if (element_ == 0) return BadPly("there is no element vertex");
    header_.data_begin = position;
    return std::move(header_);
  }

 private:
  Status ParseLine(const std::vector<std::string_view>& words) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return Status::Ok();
    if (words[0] == "format") return ParseFormat(words);
    if (words[0] == "element") return ParseElement(words);
    if (words[0] == "property") return element_ == 1 ? ParseProperty(words) : Status::Ok();
    return BadPly("unknown header line");
  }

  Status ParseFormat(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return BadPly("broken format line");
    if (words[1] != "binary_little_endian") {
      return Status(StatusKind::kUnsupportedMedia, "unsupported_ply", "only binary_little_endian PLY files are read");
    }
    has_format_ = true;
    return Status::Ok();
  }

  Status ParseElement(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return BadPly("broken element line");
    if (++element_ > 1) return Status::Ok();
    if (words[1] != "vertex") return BadPly("the first element is not vertex");
    const auto [end, error] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), header_.count);
    if (error != std::errc() || end != words[2].data() + words[2].size() || header_.count < 0) {
      return BadPly("broken number of vertices");
    }
    if (header_.count > limits_.max_points) {
      return Status(StatusKind::kTooLarge, "ply_too_large",
                    "the cloud has more than " + std::to_string(limits_.max_points) + " points");
    }
    return Status::Ok();
  }

  Status ParseProperty(const std::vector<std::string_view>& words) {
    constexpr std::size_t kMaxProperties = 256;
    if (words.size() != 3) return BadPly("a vertex property that is not a plain number");
    if (header_.properties.size() >= kMaxProperties) return BadPly("too many properties");
    for (const TypeName& known : kTypes) {
      if (known.name != words[1]) continue;
      header_.properties.push_back({std::string(words[2]), known.type, header_.vertex_bytes});
      header_.vertex_bytes += known.size;
      return Status::Ok();
    }
    return BadPly("unknown property type");
  }

  PlyLimits limits_;
  Header header_;
  bool has_format_ = false;
  int element_ = 0;
};

template <typename T>
double LoadAs(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

double Load(const char* at, Type type) {
  switch (type) {
    case Type::kInt8:
      return LoadAs<std::int8_t>(at);
    case Type::kUint8:
      return LoadAs<std::uint8_t>(at);
    case Type::kInt16:
      return LoadAs<std::int16_t>(at);
    case Type::kUint16:
      return LoadAs<std::uint16_t>(at);
    case Type::kInt32:
      return LoadAs<std::int32_t>(at);
    case Type::kUint32:
      return LoadAs<std::uint32_t>(at);
    case Type::kFloat:
      return LoadAs<float>(at);
    case Type::kDouble:
      return LoadAs<double>(at);
  }
  return 0;
}

/// The vertices of a file whose header was read and whose length was checked.
class VertexReader {
 public:
  VertexReader(const Header& header, std::string_view bytes)
      : header_(header), data_(bytes.data() + header.data_begin) {}

  bool Has(std::string_view name) const { return Find(name) != nullptr; }

  /// Calls set(i, value) for every vertex.
  template <typename Set>
  void ForEach(std::string_view name, Set&& set) const {
    const Property& property = *Find(name);
    for (std::int64_t i = 0; i < header_.count; ++i) {
      set(static_cast<std::size_t>(i),
          Load(data_ + static_cast<std::size_t>(i) * header_.vertex_bytes + property.offset, property.type));
    }
  }

 private:
  const Property* Find(std::string_view name) const {
    for (const Property& property : header_.properties) {
      if (property.name == name) return &property;
    }
    return nullptr;
  }

  const Header& header_;
  const char* data_;
};

template <typename Vector>
void ReadTriple(const VertexReader& reader, const std::array<const char*, 3>& names, std::size_t count,
                std::vector<Vector>* values) {
  using Scalar = typename Vector::Scalar;
  for (const char* name : names) {
    if (!reader.Has(name)) return;
  }
  values->resize(count);
  for (int axis = 0; axis < 3; ++axis) {
    reader.ForEach(names[axis], [&](std::size_t i, double value) {
      if constexpr (std::is_same_v<Scalar, std::uint8_t>) {
        (*values)[i][axis] = value >= 0 && value <= 255 ? static_cast<std::uint8_t>(value) : 0;
      } else {
        (*values)[i][axis] = static_cast<float>(value);
      }
    });
  }
}

void ReadScalars(const VertexReader& reader, const char* name, std::size_t count, std::vector<float>* values) {
  if (!reader.Has(name)) return;
  values->resize(count);
  reader.ForEach(name, [&](std::size_t i, double value) { (*values)[i] = static_cast<float>(value); });
}

/// The header of a file that holds all of its vertices.
Result<Header> ReadHeader(std::string_view bytes, const PlyLimits& limits) {
  DRUPE_ASSIGN_OR_RETURN(Header header, HeaderParser(limits).Parse(bytes));
  // Both factors are limited, so the product cannot overflow; memory is taken only for what the file really holds.
  if (bytes.size() - header.data_begin < static_cast<std::size_t>(header.count) * header.vertex_bytes) {
    return BadPly("the file ends before its vertices");
  }
  return header;
}

std::string HeaderOf(const PointCloud& cloud) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment drupe dense cloud\nelement vertex " +
                       std::to_string(cloud.size()) + "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!cloud.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!cloud.colours.empty()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!cloud.raw_colours.empty())
    header += "property uchar raw_red\nproperty uchar raw_green\nproperty uchar raw_blue\n";
  if (!cloud.view_counts.empty()) header += "property uchar views\n";
  if (!cloud.ncc.empty()) header += "property float ncc\n";
  if (!cloud.expected_error.empty()) header += "property float expected_error\n";
  return header + "end_header\n";
}

}  // namespace

std::string WritePly(const PointCloud& cloud) {
  constexpr std::size_t kLargestVertex = 39;
  std::string out = HeaderOf(cloud);
  out.reserve(out.size() + kLargestVertex * cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    PutValues(cloud.positions[i].data(), 3, &out);
    if (!cloud.normals.empty()) PutValues(cloud.normals[i].data(), 3, &out);
    if (!cloud.colours.empty()) PutValues(cloud.colours[i].data(), 3, &out);
    if (!cloud.raw_colours.empty()) PutValues(cloud.raw_colours[i].data(), 3, &out);
    if (!cloud.view_counts.empty()) PutValues(&cloud.view_counts[i], 1, &out);
    if (!cloud.ncc.empty()) PutValues(&cloud.ncc[i], 1, &out);
    if (!cloud.expected_error.empty()) PutValues(&cloud.expected_error[i], 1, &out);
  }
  return out;
}

Result<PointCloud> ReadPly(std::string_view bytes, const PlyLimits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const Header header, ReadHeader(bytes, limits));
  const auto count = static_cast<std::size_t>(header.count);
  const VertexReader reader(header, bytes);
  if (!reader.Has("x") || !reader.Has("y") || !reader.Has("z")) return BadPly("x, y or z is missing");
  PointCloud cloud;
  ReadTriple(reader, {"x", "y", "z"}, count, &cloud.positions);
  for (const Eigen::Vector3f& position : cloud.positions) {
    if (!position.allFinite()) return BadPly("a position is not a finite number");
  }
  ReadTriple(reader, {"nx", "ny", "nz"}, count, &cloud.normals);
  ReadTriple(reader, {"red", "green", "blue"}, count, &cloud.colours);
  ReadTriple(reader, {"raw_red", "raw_green", "raw_blue"}, count, &cloud.raw_colours);
  ReadScalars(reader, "ncc", count, &cloud.ncc);
  ReadScalars(reader, "expected_error", count, &cloud.expected_error);
  std::vector<float> views;
  ReadScalars(reader, "views", count, &views);
  for (const float value : views) {
    cloud.view_counts.push_back(value >= 0 && value <= 255 ? static_cast<std::uint8_t>(value) : 0);
  }
  return cloud;
}

Result<std::vector<float>> ReadPlyScalar(std::string_view bytes, const char* property, const PlyLimits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const Header header, ReadHeader(bytes, limits));
  std::vector<float> values;
  ReadScalars(VertexReader(header, bytes), property, static_cast<std::size_t>(header.count), &values);
  return values;
}

}  // namespace drupe
