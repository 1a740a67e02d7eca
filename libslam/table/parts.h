#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/table/table.h"

namespace slam::table {

// What the writers of tables share; for them alone.

/// ContractError unless every row is as long as the columns and no key comes twice.
void checkTable(const Table& table);
bool isNumeric(const Table& table, size_t column);
std::string onOneLine(std::string text);
/// "-" for NaN, "inf" and "-inf"; a value that rounds to zero has no sign.
std::string fixedText(double value, int decimals);
/// A number's digits without its sign; Column::shows_bound is kept to.
std::string shownNumber(double number, const Column& column);

/// files::wrapped(), with no line for a text without words.
std::vector<std::string> wrapped(const std::string& text, std::size_t limit);
/// Letters of the longest.
std::size_t longest(const std::vector<std::string>& lines);

}  // namespace slam::table
