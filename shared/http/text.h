#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace drupe {

/// Without the spaces and tabs at either end, as HTTP allows them around a field's value (RFC 9110, 5.6.3).
inline std::string_view Trim(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// In lower case as ASCII has it: names of fields and tokens are compared so.
inline char Lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

inline std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = Lower(c);
  return lower;
}

}  // namespace drupe
