#include "libslam/calibration/thinned_sample.h"

#include "libslam/core/middle_value.h"

namespace slam::calibration {
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
  return core::valueOfRank(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

}  // namespace slam::calibration
