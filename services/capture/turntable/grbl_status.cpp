#include <array>
#include <cstdlib>
#include <vector>

#include "capture/turntable/grbl_turntable.h"

namespace drupe {
namespace {

/// "1.0,2.0" to numbers; stops at what is none.
std::vector<double> Numbers(std::string_view text) {
  std::vector<double> numbers;
  std::string copy(text);
  const char* position = copy.c_str();
  while (*position != '\0') {
    char* end = nullptr;
    const double number = std::strtod(position, &end);
    if (end == position) break;
    numbers.push_back(number);
    position = *end == ',' ? end + 1 : end;
  }
  return numbers;
}

std::optional<double> AxisValue(std::string_view text, char axis) {
  static constexpr std::string_view kAxes = "XYZABC";
  const std::vector<double> numbers = Numbers(text);
  const std::size_t index = kAxes.find(axis);
  if (index >= numbers.size()) return std::nullopt;
  return numbers[index];
}

}  // namespace

std::optional<GrblStatus> ParseGrblStatus(std::string_view line, char axis) {
  if (line.size() < 2 || line.front() != '<' || line.back() != '>') return std::nullopt;
  line = line.substr(1, line.size() - 2);
  GrblStatus status;
  std::optional<double> machine, work, offset;
  for (bool first = true; !line.empty(); first = false) {
    const std::size_t end = line.find('|');
    const std::string_view field = line.substr(0, end);
    line = end == std::string_view::npos ? std::string_view() : line.substr(end + 1);
    if (first) status.state = field.substr(0, field.find(':'));
    if (field.starts_with("MPos:")) machine = AxisValue(field.substr(5), axis);
    if (field.starts_with("WPos:")) work = AxisValue(field.substr(5), axis);
    if (field.starts_with("WCO:")) offset = AxisValue(field.substr(4), axis);
  }
  if (!machine && work) machine = *work + offset.value_or(0);
  if (!machine) return std::nullopt;
  status.position = *machine;
  return status;
}

}  // namespace drupe
