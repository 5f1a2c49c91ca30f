#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace drupe {

/// Appends what printf would print, cut at 319 characters.
template <typename... Values>
void AppendFormat(std::string& text, const char* format, Values... values) {
  std::array<char, 320> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  text += line.data();
}

}  // namespace drupe
