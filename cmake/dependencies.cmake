# What our rooms need from outside. Read by the build and, installed, by find_package(rasterslam).

# The packages that stand behind what a room links, by the beginning of the name that it links.
set(RASTERSLAM_PACKAGE_OF
  "opencv_=OpenCV" "Eigen3::=Eigen3" "Boost::=Boost" "nlohmann_json::=nlohmann_json" "OpenSSL::=OpenSSL" "yaml-cpp=yaml-cpp"
  "ZLIB::=ZLIB" "BZip2::=BZip2" "LibLZMA::=LibLZMA" "PkgConfig::LZ4=LZ4" "PkgConfig::ZSTD=ZSTD" "PkgConfig::CAIRO=CAIRO"
  "SQLite::=SQLite3" "Threads::=Threads")

# Finds one of these packages, or mrpt_<module>. HOW is REQUIRED or QUIET.
macro(rasterslam_find_package package how)
  string(REGEX MATCH "^mrpt_(.*)$" rasterslam_module "${package}")
  if(rasterslam_module)
    rasterslam_find_mrpt(${CMAKE_MATCH_1} ${how})
  elseif("${package}" STREQUAL "OpenCV")
    find_package(OpenCV ${how} COMPONENTS core imgproc imgcodecs)
  elseif("${package}" MATCHES "^(LZ4|ZSTD|CAIRO)$")
    find_package(PkgConfig ${how})
    string(TOLOWER "${package}" rasterslam_module)
    if("${package}" MATCHES "LZ4|ZSTD")
      string(PREPEND rasterslam_module lib)
    endif()
    if(NOT TARGET PkgConfig::${package})
      pkg_check_modules(${package} ${how} IMPORTED_TARGET GLOBAL ${rasterslam_module})
    endif()
  else()
    find_package(${package} ${how})
  endif()
endmacro()

# MRPT 2.x calls its packages mrpt-slam, 3.x mrpt_slam.
macro(rasterslam_find_mrpt module how)
  find_package(mrpt-${module} QUIET)
  set(mrpt_${module}_FOUND ${mrpt-${module}_FOUND})
  if(NOT TARGET mrpt::${module} AND NOT TARGET mrpt::mrpt_${module})
    find_package(mrpt_${module} ${how})
  endif()
endmacro()
