#pragma once
/// The one place that knows which MRPT is installed. Written against 2.5.8 (Debian 12); the branches for
/// later versions follow the tags in which the interfaces changed.
#if __has_include(<mrpt/core/version.h>)
#include <mrpt/core/version.h>
#else
#include <mrpt/version.h>
#endif
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <memory>
#include <string>

namespace slam::builders::compat {

// 3.0.0 changed two signatures of CMetricMapBuilder.
#if MRPT_VERSION >= 0x030000
using MapSize = size_t;
#define RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS const std::string& file
#else
using MapSize = unsigned int;
#define RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS const std::string &file, bool
#endif

// 2.9.2: getCurrentlyBuiltMetricMap() returns a reference.
#if MRPT_VERSION >= 0x020902
using BuiltMap = const mrpt::maps::CMultiMetricMap&;
inline BuiltMap builtMap(const mrpt::maps::CMultiMetricMap& map) {
  return map;
}
#else
using BuiltMap = const mrpt::maps::CMultiMetricMap*;
inline BuiltMap builtMap(const mrpt::maps::CMultiMetricMap& map) {
  return &map;
}
#endif
inline const mrpt::maps::CMultiMetricMap& asReference(const mrpt::maps::CMultiMetricMap& map) {
  return map;
}
inline const mrpt::maps::CMultiMetricMap& asReference(const mrpt::maps::CMultiMetricMap* map) {
  return *map;
}

// 2.11.3: map factories hand out shared pointers.
#if MRPT_VERSION >= 0x020B03
using MapPointer = std::shared_ptr<mrpt::maps::CMetricMap>;
template <class T>
std::shared_ptr<T> owned(T* object) {
  return std::shared_ptr<T>(object);
}
#else
using MapPointer = mrpt::maps::CMetricMap*;
template <class T>
T* owned(T* object) {
  return object;
}
#endif

// 2.14.5: a simplemap hands out its key frames as Keyframe instead of pairs.
struct SimpleMapFrame {
  mrpt::poses::CPose3DPDF::ConstPtr pose;
  mrpt::obs::CSensoryFrame::ConstPtr observations;
};
inline SimpleMapFrame frameOf(const mrpt::maps::CSimpleMap& map, size_t index) {
#if MRPT_VERSION >= 0x020E05
  const auto& frame = map.get(index);
#else
  const auto frame = map.getAsPair(index);
#endif
  return {frame.pose, frame.sf};
}

/// A copy of both goes into the map; of the observations only the pointers. Every version has the insert() of
/// pointers.
inline void insertFrame(mrpt::maps::CSimpleMap& map, const mrpt::poses::CPose3DPDFGaussian& pose,
                        const mrpt::obs::CSensoryFrame& observations) {
  map.insert(mrpt::poses::CPose3DPDF::Ptr(std::make_shared<mrpt::poses::CPose3DPDFGaussian>(pose)),
             std::make_shared<mrpt::obs::CSensoryFrame>(observations));
}

}  // namespace slam::builders::compat
