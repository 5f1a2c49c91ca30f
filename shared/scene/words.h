#pragma once

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace drupe {

/// For tests: the words of each line.
inline std::vector<std::vector<std::string>> Words(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    lines.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return lines;
}

}  // namespace drupe
