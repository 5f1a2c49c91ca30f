#include "cli/bench/ply_positions.h"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

namespace drupe {

namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is read as it lies in memory");

/// A scalar of PLY: its size in bytes, and how it is read.
struct Scalar {
  std::size_t size;
  double (*read)(const char* bytes);
};

template <typename T>
double ReadAs(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

const Scalar* FindScalar(const std::string& name) {
  static const std::map<std::string, Scalar> kScalars = {
      {"char", {1, ReadAs<std::int8_t>}},     {"int8", {1, ReadAs<std::int8_t>}},
      {"uchar", {1, ReadAs<std::uint8_t>}},   {"uint8", {1, ReadAs<std::uint8_t>}},
      {"short", {2, ReadAs<std::int16_t>}},   {"int16", {2, ReadAs<std::int16_t>}},
      {"ushort", {2, ReadAs<std::uint16_t>}}, {"uint16", {2, ReadAs<std::uint16_t>}},
      {"int", {4, ReadAs<std::int32_t>}},     {"int32", {4, ReadAs<std::int32_t>}},
      {"uint", {4, ReadAs<std::uint32_t>}},   {"uint32", {4, ReadAs<std::uint32_t>}},
      {"float", {4, ReadAs<float>}},          {"float32", {4, ReadAs<float>}},
      {"double", {8, ReadAs<double>}},        {"float64", {8, ReadAs<double>}}};
  const auto found = kScalars.find(name);
  return found == kScalars.end() ? nullptr : &found->second;
}

/// One property of a vertex.
struct Property {
  const Scalar* count = nullptr;  ///< of a list; null: a scalar
  const Scalar* value = nullptr;
  int axis = -1;  ///< 0, 1, 2 for x, y, z
};

struct Header {
  bool ascii = false;
  std::size_t vertices = 0;
  std::vector<Property> properties;
};

/// Takes "property TYPE NAME" or "property list TYPE TYPE NAME", of which the first word is read.
std::optional<Property> ParseProperty(std::istringstream& words) {
  Property property;
  std::string type, name;
  words >> type;
  if (type == "list") {
    words >> name >> type;
    property.count = FindScalar(name);
    if (property.count == nullptr) return std::nullopt;
  }
  words >> name;
  property.value = FindScalar(type);
  if (property.value == nullptr || words.fail()) return std::nullopt;
  if (property.count == nullptr && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') property.axis = name[0] - 'x';
  return property;
}

Status BadPly(const std::string& what) {
  return Unprocessable("bad_ply", "not a PLY file with points: " + what);
}

Result<Header> ParseHeader(std::istringstream& stream) {
  Header header;
  std::string line, element;
  while (std::getline(stream, line) && line.rfind("end_header", 0) != 0) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> word;
      header.ascii = word == "ascii";
      if (!header.ascii && word != "binary_little_endian") return BadPly("format " + word);
    } else if (word == "element") {
      if (element.empty())
        words >> element >> header.vertices;
      else
        element = "later";
    } else if (word == "property" && element == "vertex") {
      const std::optional<Property> property = ParseProperty(words);
      if (!property) return BadPly(line);
      header.properties.push_back(*property);
    }
  }
  if (!stream) return BadPly("the header does not end");
  if (element.empty()) return BadPly("there are no vertices");
  return header;
}

/// Reads vertices from the bytes or words after the header.
class VertexReader {
 public:
  VertexReader(const Header& header, std::istringstream& stream, std::string_view bytes)
      : header_(header), stream_(stream), bytes_(bytes) {}

  /// False when the file ends before the vertex does.
  bool Read(Eigen::Vector3f* position) {
    for (const Property& property : header_.properties) {
      double value = 0;
      std::size_t times = 1;
      if (property.count != nullptr) {
        if (!Next(*property.count, &value) || !(value >= 0)) return false;
        times = static_cast<std::size_t>(value);
      }
      for (std::size_t i = 0; i < times; ++i) {
        if (!Next(*property.value, &value)) return false;
      }
      if (property.axis >= 0) (*position)[property.axis] = static_cast<float>(value);
    }
    return true;
  }

 private:
  bool Next(const Scalar& scalar, double* value) {
    if (header_.ascii) {
      std::string word;  // strtod knows nan, which streams do not
      if (!(stream_ >> word)) return false;
      *value = std::strtod(word.c_str(), nullptr);
      return true;
    }
    if (bytes_.size() < scalar.size) return false;
    *value = scalar.read(bytes_.data());
    bytes_.remove_prefix(scalar.size);
    return true;
  }

  const Header& header_;
  std::istringstream& stream_;
  std::string_view bytes_;
};

}  // namespace

Result<PointCloud> ReadPlyPositions(const std::string& bytes) {
  std::istringstream stream(bytes);
  DRUPE_ASSIGN_OR_RETURN(const Header header, ParseHeader(stream));
  VertexReader reader(header, stream, std::string_view(bytes).substr(static_cast<std::size_t>(stream.tellg())));
  PointCloud cloud;
  for (std::size_t i = 0; i < header.vertices; ++i) {
    Eigen::Vector3f position = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
    if (header.properties.empty() || !reader.Read(&position)) return BadPly("it ends before the last vertex");
    if (position.allFinite()) cloud.positions.push_back(position);
  }
  return cloud;
}

}  // namespace drupe
