#pragma once
#include <string>

#include "libslam/report/table.h"

namespace slam::report {

// What the writers of tables share; for them alone.

/// ContractError unless every row is as long as the columns and no key comes twice.
void checkTable(const Table& table);
bool isNumeric(const Table& table, size_t column);
std::string onOneLine(std::string text);

}  // namespace slam::report
