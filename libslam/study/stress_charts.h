#pragma once
#include <string>
#include <vector>

#include "libslam/draw/curves.h"
#include "libslam/table/table.h"

namespace slam::study {

/// Of the table `stress.csv` of a stress test: the error and the share of failed runs over what was varied,
/// with intervals as whiskers; the axis of what was varied is logarithmic where its values are spaced so.
/// Errors: InputError that begins with the path, where a column is missing.
std::vector<draw::Chart> stressCharts(const table::Table& stress, const std::string& path);

}  // namespace slam::study
