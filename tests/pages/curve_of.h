#pragma once
#include <string>

#include "libslam/core/error.h"
#include "libslam/draw/curves.h"

namespace slam::pages {

inline const draw::Curve& curveOf(const draw::Chart& chart, const std::string& label) {
  for (const auto& curve : chart.curves)
    if (curve.label == label) return curve;
  throw core::ContractError("no curve " + label);
}

}  // namespace slam::pages
