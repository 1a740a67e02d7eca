#include <mrpt/core/Clock.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "libslam/builders/map_grid.h"
#include "libslam/builders/mrpt_compat.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/memory_guard.h"
#include "libslam/files/ros_map.h"
#include "libslam/files/trial_run.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/gridmap/mrpt_grid.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/mapping/key_frames.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/mapping/simple_map.h"
#include "libslam/posegraph/g2o_io.h"
#include "libslam/resources/gzip.h"

namespace slam::mapping {
namespace {

using mrpt::maps::COccupancyGridMap2D;

/// The grid that any MRPT program opens, whatever class the method uses.
COccupancyGridMap2D plainCopy(const COccupancyGridMap2D& grid) {
  COccupancyGridMap2D plain;
  plain.copyMapContentFrom(grid);
  plain.insertionOptions = grid.insertionOptions;
  plain.likelihoodOptions = grid.likelihoodOptions;
  return plain;
}

void serialise(const mrpt::serialization::CSerializable& object, mrpt::io::CMemoryStream& buffer) {
  mrpt::serialization::archiveFrom(buffer) << object;
}

/// MRPT's own writers go through gzip streams that do not report a full disk.
void writePacked(const mrpt::io::CMemoryStream& buffer, const std::string& path) {
  resources::writeGzipFile(
      path, {static_cast<const char*>(buffer.getRawBufferData()), buffer.getTotalBytesCount()});
}

void writeObject(const mrpt::serialization::CSerializable& object, const std::string& path) {
  mrpt::io::CMemoryStream buffer;
  serialise(object, buffer);
  writePacked(buffer, path);
}

/// The copy, which may be large, is gone before the map is packed.
void writeGrid(const COccupancyGridMap2D& grid, const std::string& path) {
  mrpt::io::CMemoryStream buffer;
  serialise(plainCopy(grid), buffer);
  writePacked(buffer, path);
}

/// ROS's picture of the map, the top row first.
void writeRosMap(const gridmap::OccupancyRaster& map, const std::string& folder) {
  cv::Mat picture(map.rows, map.columns, CV_8UC1);
  for (int row = 0; row < map.rows; ++row) {
    auto* pixels = picture.ptr<std::uint8_t>(map.rows - 1 - row);
    const float* cells = map.occupancy.data() + static_cast<size_t>(row) * static_cast<size_t>(map.columns);
    for (int column = 0; column < map.columns; ++column) {
      std::uint8_t gray = files::kRosUnknown;
      if (cells[column] > gridmap::kOccupiedAbove) gray = files::kRosOccupied;
      if (cells[column] < gridmap::kFreeBelow) gray = files::kRosFree;
      pixels[column] = gray;
    }
  }
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", picture, png)) throw core::IoError(folder + "/map.png: cannot be encoded");
  files::writeFileAtomically(folder + "/map.png", {reinterpret_cast<const char*>(png.data()), png.size()});
  files::writeFileAtomically(
      folder + "/map.yaml",
      "# ROS map_server. Cells are occupied above a probability of 0.6, free below 0.4, unknown between.\n" +
          files::rosMapYaml({"map.png", map.resolution_m, {map.x_min_m, map.y_min_m, 0}}));
}

/// The first scan of a frame, where it has one.
std::optional<KeyFrame> scanOf(const mrpt::maps::CSimpleMap& map, size_t frame_number) {
  const auto [pose, frame] = builders::compat::frameOf(map, frame_number);
  const auto observation = frame->getObservationByClass<mrpt::obs::CObservation2DRangeScan>();
  if (!observation) return std::nullopt;
  const auto mean = pose->getMeanVal();
  return KeyFrame{lidar::fromMrpt(*observation), {mean.x(), mean.y(), mean.yaw()}};
}

}  // namespace

void saveMaps(const MapBuilder& method, const std::string& folder) {
  saveMaps(method, currentMap(method), folder);
}

void saveMaps(const MapBuilder& method, const gridmap::OccupancyRaster& map, const std::string& folder) {
  writeRosMap(map, folder);
  writeGrid(*builders::gridOf(mrptBuilder(method)), folder + "/map.gridmap.gz");
  saveKeyFrames(method, folder);
}

void saveRaster(const gridmap::OccupancyRaster& map, const std::string& folder) {
  if (map.occupancy.empty()) throw core::ContractError("saveRaster: a map without a cell");
  writeRosMap(map, folder);
  const auto edge_m = [&](double from_m, int cells) {
    return static_cast<float>(from_m + cells * map.resolution_m);
  };
  COccupancyGridMap2D grid(edge_m(map.x_min_m, 0), edge_m(map.x_min_m, map.columns), edge_m(map.y_min_m, 0),
                           edge_m(map.y_min_m, map.rows), static_cast<float>(map.resolution_m));
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column) grid.setCell(column, row, 1 - map.at(column, row));
  writeObject(grid, folder + "/map.gridmap.gz");
}

void writeKeyFrames(const std::vector<KeyFrame>& key_frames, const std::string& path) {
  mrpt::maps::CSimpleMap map;
  for (const KeyFrame& key_frame : key_frames) {
    const auto observation = lidar::toMrpt(key_frame.scan);
    observation->timestamp = mrpt::Clock::fromDouble(key_frame.scan.time_s);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(observation);
    mrpt::poses::CPose3DPDFGaussian pose;
    pose.mean = mrpt::poses::CPose3D(mrpt::poses::CPose2D(lidar::toMrpt(key_frame.T_map_robot)));
    builders::compat::insertFrame(map, pose, frame);
  }
  writeObject(map, path);
}

gridmap::OccupancyRaster readGridMap(const std::string& path) {
  files::requireReadableFile(path);
  COccupancyGridMap2D grid;
  try {
    files::doTried([&] {
      const files::MemoryGuard guard(files::fileHeadroomBytes(path));
      mrpt::io::CFileGZInputStream file(path);
      mrpt::serialization::archiveFrom(file) >> grid;
    });
  } catch (const std::bad_alloc&) {
    throw core::InputError(path + ": found a grid of impossible size, expected an MRPT occupancy grid");
  } catch (const std::length_error&) {
    throw core::InputError(path + ": found a grid of impossible size, expected an MRPT occupancy grid");
  } catch (const std::exception&) {
    throw core::InputError(path + ": is no MRPT occupancy grid");
  }
  return gridmap::fromMrpt(grid);
}

mrpt::maps::CSimpleMap loadSimpleMap(const std::string& path) {
  files::requireReadableFile(path);
  mrpt::maps::CSimpleMap map;
  try {
    files::doTried([&] {
      const files::MemoryGuard guard(files::fileHeadroomBytes(path));
      mrpt::io::CFileGZInputStream file(path);  // not loadFromFile(), which says nothing of why it fails
      mrpt::serialization::archiveFrom(file) >> map;
    });
  } catch (const std::bad_alloc&) {
    throw core::InputError(path + ": found key frames of impossible size, expected an MRPT simplemap");
  } catch (const std::length_error&) {
    throw core::InputError(path + ": found key frames of impossible size, expected an MRPT simplemap");
  } catch (const std::exception&) {
    throw core::InputError(path + ": is no MRPT simplemap");
  }
  if (map.empty()) throw core::InputError(path + ": holds 0 key frames, expected at least 1");
  for (size_t i = 0; i < map.size(); ++i)
    if (scanOf(map, i)) return map;
  throw core::InputError(path + ": holds 0 laser scans, expected at least 1");
}

std::vector<KeyFrame> readKeyFrames(const std::string& path) {
  const auto map = loadSimpleMap(path);
  std::vector<KeyFrame> key_frames;
  for (size_t i = 0; i < map.size(); ++i)
    if (const auto key_frame = scanOf(map, i)) key_frames.push_back(*key_frame);
  return key_frames;
}

void saveKeyFrames(const MapBuilder& method, const std::string& folder) {
  mrpt::maps::CSimpleMap key_frames;
  mrptBuilder(method).getCurrentlyBuiltMap(key_frames);
  writeObject(key_frames, folder + "/map.simplemap");
  const graph::GraphSlam* slam = graphSlamOf(method);
  const bool has_mapped = mrptBuilder(method).options.enableMapUpdating;
  if (slam != nullptr && has_mapped) posegraph::writeG2oFile(slam->graph(), {}, folder + "/graph.g2o");
}

}  // namespace slam::mapping
