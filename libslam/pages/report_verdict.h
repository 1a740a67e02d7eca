#pragma once
#include <string>
#include <vector>

#include "libslam/score/evaluate.h"

namespace slam::pages {

// What the report says of runs in words.

/// Rows in the order of their error, or where no truth is known of how far they are from the others; those
/// without such a figure last.
void sortByWorth(std::vector<score::Evaluation>& evaluations, bool has_truth);

/// The sentences that head the page, of evaluations in the order of sortByWorth().
std::vector<std::string> verdictOf(const std::vector<score::Evaluation>& evaluations, bool has_truth);
/// Of one run; "" where it has no path.
std::string summaryOf(const score::Evaluation& evaluation, bool has_truth);

/// "12.5 %" of 0.125.
std::string percent(double share);

}  // namespace slam::pages
