#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/doctor/log_check.h"

namespace slam::doctor {

/// As printf() writes it.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
/// A count for "%lu".
unsigned long n(std::uint64_t count);
/// Of nothing: 0.
double share(std::uint64_t part, std::uint64_t whole);
std::string plural(std::uint64_t count, const char* one, const char* more);
/// "1.003 (0.998 to 1.008)"
std::string shown(const calibration::Estimate& e, double factor, int decimals);
/// "0 to 3, 17 and 170 to 179", shortened after six runs. REQUIRES rising numbers.
std::string beamList(const std::vector<int>& beams);

}  // namespace slam::doctor
