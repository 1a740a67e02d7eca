# What `cmake --install` puts where. Components: programs (what a user runs, with its data), development (headers, libraries
# and what finds them), documentation.
include(GNUInstallDirs)
install(TARGETS rasterslam RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
if(TARGET rasterslam_view)
  install(TARGETS rasterslam_view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
endif()
foreach(plugin rasterslam_mrpt_plugin rasterslam_sensor_plugin)
  if(TARGET ${plugin})
    install(TARGETS ${plugin} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT programs)
  endif()
endforeach()

# The data is found beside the program (libslam/core/data_folder.h), wherever the whole is moved.
set(data ${CMAKE_INSTALL_DATADIR}/rasterslam)
file(WRITE ${PROJECT_BINARY_DIR}/VERSION "${PROJECT_VERSION}\n")
install(DIRECTORY configs datasets/worlds DESTINATION ${data} COMPONENT programs USE_SOURCE_PERMISSIONS)
install(FILES datasets/public_data.json ${PROJECT_BINARY_DIR}/VERSION DESTINATION ${data} COMPONENT programs)

install(FILES LICENSE README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
