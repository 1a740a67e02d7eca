#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libslam/table/table.h"

namespace slam::report {

// The HTML report's tables, and its lists of what words mean.

/// What names mean.
using Meanings = std::map<std::string, std::string>;

/// A table that can be sorted and filtered; its columns explain themselves, by key or title, when pointed at
/// and in a list below. The first kMostTableRows rows, and how many there are; the notes.
std::string tableElement(const table::Table& table, const Meanings& meanings);

/// A list of names and meanings that opens and closes, in this order; "" for none.
std::string meaningsElement(const std::string& id, const std::string& heading,
                            const std::vector<std::pair<std::string, std::string>>& meanings, bool is_open);

}  // namespace slam::report
