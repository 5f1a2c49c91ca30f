#pragma once

#include <string>
#include <vector>

namespace drupe {

/// A table for the terminal: the first column to the left, the others to the right, one space or more between, a line
/// of dashes under the heading. Rows may be shorter than the heading.
std::string FormatTextTable(const std::vector<std::string>& heading, const std::vector<std::vector<std::string>>& rows);

/// `value` with so many decimals.
std::string FixedText(double value, int decimals);

}  // namespace drupe
