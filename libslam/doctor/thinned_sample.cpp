#include "libslam/doctor/thinned_sample.h"

#include <algorithm>

namespace slam::doctor {
namespace {
constexpr std::size_t kMostKept = 1 << 16;
}

void ThinnedSample::add(double value) {
  if (count_++ % stride_ != 0) return;
  kept_.push_back(value);
  if (kept_.size() < kMostKept) return;
  for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
  kept_.resize((kept_.size() + 1) / 2);
  stride_ *= 2;
}

double ThinnedSample::quantile(double share) const {
  if (kept_.empty()) return 0;
  auto values = kept_;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

}  // namespace slam::doctor
