# One name for the MRPT modules that a room links, whichever generation is installed:
# 2.x calls its packages mrpt-slam and mrpt::slam, 3.x mrpt_slam and mrpt::mrpt_slam.
function(rasterslam_find_mrpt module)
  find_package(mrpt-${module} QUIET)
  add_library(rasterslam_mrpt_${module} INTERFACE)
  if(TARGET mrpt::${module})
    target_link_libraries(rasterslam_mrpt_${module} INTERFACE mrpt::${module})
  else()
    find_package(mrpt_${module} REQUIRED)
    target_link_libraries(rasterslam_mrpt_${module} INTERFACE mrpt::mrpt_${module})
  endif()
  add_library(rasterslam::mrpt_${module} ALIAS rasterslam_mrpt_${module})
endfunction()

rasterslam_find_mrpt(obs)
rasterslam_find_mrpt(maps)
rasterslam_find_mrpt(slam)
rasterslam_find_mrpt(opengl)
