#pragma once
#include <complex>

#include "libslam/core/elementary.h"

namespace slam::certified {

/// The complex number of length 1 at this angle: a rotation of the plane.
inline std::complex<double> unitComplex(double phi_rad) {
  const auto [sine, cosine] = core::sinCos(phi_rad);
  return {cosine, sine};
}

}  // namespace slam::certified
