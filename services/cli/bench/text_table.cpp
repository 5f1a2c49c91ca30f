#include "cli/bench/text_table.h"

#include <algorithm>
#include <cstdio>

namespace drupe {

namespace {

using Row = std::vector<std::string>;

std::string FormatRow(const Row& row, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i) {
    const std::string padding(widths[i] - std::min(widths[i], row[i].size()), ' ');
    line += i == 0 ? row[i] + padding : "  " + padding + row[i];
  }
  return line + "\n";
}

}  // namespace

std::string FormatTextTable(const Row& heading, const std::vector<Row>& rows) {
  std::vector<std::size_t> widths;
  for (const std::string& cell : heading) widths.push_back(cell.size());
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  Row dashes;
  for (const std::size_t width : widths) dashes.emplace_back(width, '-');
  std::string text = FormatRow(heading, widths) + FormatRow(dashes, widths);
  for (const Row& row : rows) text += FormatRow(row, widths);
  return text;
}

std::string FixedText(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace drupe
