# ROS 1's own library, only for tests to compare ours with; newer Debian releases may not have it.
#   rasterslam::rosbag, or no such target when anything is missing.
include(CheckCXXSourceCompiles)

# Debian keeps the headers that <rosbag/bag.h> includes in folders of their own, without a working .pc file.
set(folders)
foreach(name pluginlib class_loader rcutils rcpputils ament_index_cpp)
  if(EXISTS /usr/include/${name}/${name})
    list(APPEND folders /usr/include/${name})
  endif()
endforeach()
set(CMAKE_REQUIRED_INCLUDES ${folders})
set(CMAKE_REQUIRED_LIBRARIES rosbag_storage roscpp_serialization rostime cpp_common console_bridge)
check_cxx_source_compiles([[
#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/MultiEchoLaserScan.h>
#include <tf2_msgs/TFMessage.h>
int main() { rosbag::Bag bag; rosbag::View view(bag); return static_cast<int>(view.size()); }
]] RASTERSLAM_HAS_ROSBAG)
if(RASTERSLAM_HAS_ROSBAG)
  add_library(rasterslam_rosbag INTERFACE)
  target_include_directories(rasterslam_rosbag SYSTEM INTERFACE ${folders})
  target_link_libraries(rasterslam_rosbag INTERFACE ${CMAKE_REQUIRED_LIBRARIES})
  target_compile_definitions(rasterslam_rosbag INTERFACE RASTERSLAM_HAS_ROSBAG)
  add_library(rasterslam::rosbag ALIAS rasterslam_rosbag)
else()
  message(STATUS "librosbag not found: ROS 1 bags are tested without ROS's own reader and writer")
endif()
unset(CMAKE_REQUIRED_INCLUDES)
unset(CMAKE_REQUIRED_LIBRARIES)
