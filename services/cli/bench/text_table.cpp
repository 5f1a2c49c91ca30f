#include "cli/bench/text_table.h"

#include <algorithm>
#include <cstdio>

namespace drupe {

namespace {

using TextRow = std::vector<std::string>;

std::string FormatRow(const TextRow& row, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i) {
    const std::string padding(widths[i] - std::min(widths[i], row[i].size()), ' ');
    line += i == 0 ? row[i] + padding : "  " + padding + row[i];
  }
  return line + "\n";
}

}  // namespace

std::string FormatTextTable(const TextRow& heading, const std::vector<TextRow>& rows) {
  std::vector<std::size_t> widths;
  for (const std::string& cell : heading) widths.push_back(cell.size());
  for (const TextRow& row : rows) {
    for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  TextRow dashes;
  for (const std::size_t width : widths) dashes.emplace_back(width, '-');
  std::string text = FormatRow(heading, widths) + FormatRow(dashes, widths);
  for (const TextRow& row : rows) text += FormatRow(row, widths);
  return text;
}

std::string FixedText(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace drupe
