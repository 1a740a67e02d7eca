# One name, rasterslam::mrpt_<module>, for an MRPT module that was found, whichever generation: 2.x calls its targets mrpt::slam,
# 3.x mrpt::mrpt_slam. No such target where the module is missing.
function(rasterslam_name_mrpt module)
  if(TARGET mrpt::${module})
    set(behind mrpt::${module})
  elseif(TARGET mrpt::mrpt_${module})
    set(behind mrpt::mrpt_${module})
  else()
    return()
  endif()
  add_library(rasterslam_mrpt_${module} INTERFACE)
  target_link_libraries(rasterslam_mrpt_${module} INTERFACE ${behind})
  add_library(rasterslam::mrpt_${module} ALIAS rasterslam_mrpt_${module})
endfunction()
