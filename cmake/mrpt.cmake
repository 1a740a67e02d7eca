# One name for the MRPT modules that a room links, whichever generation is installed:
# 2.x calls its packages mrpt-slam and mrpt::slam, 3.x mrpt_slam and mrpt::mrpt_slam.
# With OPTIONAL a module that is missing is no error; then there is no target rasterslam::mrpt_<module>.
function(rasterslam_find_mrpt module)
  find_package(mrpt-${module} QUIET)
  if(NOT TARGET mrpt::${module} AND "OPTIONAL" IN_LIST ARGN)
    find_package(mrpt_${module} QUIET)
    if(NOT TARGET mrpt::mrpt_${module})
      return()
    endif()
  endif()
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
rasterslam_find_mrpt(kinematics)
rasterslam_find_mrpt(hwdrivers OPTIONAL)  # the sensor plugin
rasterslam_find_mrpt(gui OPTIONAL)        # the live window
rasterslam_find_mrpt(nav OPTIONAL)        # MRPT's reactive navigation as a motion method
