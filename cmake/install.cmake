# What `cmake --install` puts where. Components: programs (what a user runs, with its data), development (headers, libraries
# and what finds them), documentation.
include(GNUInstallDirs)
include(cmake/pkg_config.cmake)
if(RASTERSLAM_PROGRAMS)
  install(TARGETS rasterslam RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  if(TARGET rasterslam_view)
    install(TARGETS rasterslam_view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  endif()
  foreach(plugin rasterslam_mrpt_plugin rasterslam_sensor_plugin)
    if(TARGET ${plugin})
      install(TARGETS ${plugin} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT programs)
    endif()
  endforeach()
  install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs FILES_MATCHING PATTERN "*.1.gz")
  install(FILES apps/completion/rasterslam.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          RENAME rasterslam COMPONENT programs)
  install(FILES apps/completion/_rasterslam DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT programs)
endif()

# The data is found beside the program (libslam/core/data_folder.h), wherever the whole is moved.
set(data ${CMAKE_INSTALL_DATADIR}/rasterslam)
file(WRITE ${PROJECT_BINARY_DIR}/VERSION "${PROJECT_VERSION}\n")
install(DIRECTORY configs datasets/worlds DESTINATION ${data} COMPONENT programs USE_SOURCE_PERMISSIONS)
install(FILES datasets/public_data.json ${PROJECT_BINARY_DIR}/VERSION DESTINATION ${data} COMPONENT programs)

install(FILES LICENSE README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)

# The library: every room but those that only programs of ours and tests link.
set(exported ${RASTERSLAM_ROOMS})
list(REMOVE_ITEM exported live plugin testing)
set(RASTERSLAM_ROOM_TABLE "")
set(modules "")
foreach(room IN LISTS exported)
  install(TARGETS slam_${room} EXPORT rasterslam ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  if(NOT room STREQUAL "base")
    file(GLOB_RECURSE headers RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/libslam/${room}/*.h)
    list(REMOVE_ITEM headers libslam/core/json_entry.h)  # for our own sources: it wants nlohmann_json
    foreach(header IN LISTS headers)
      get_filename_component(folder ${header} DIRECTORY)
      install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT development)
    endforeach()
  endif()
  rasterslam_close_rooms(${room} below packages)
  list(REMOVE_ITEM packages nlohmann_json Boost)  # headers alone, of which ours show nothing
  foreach(package IN LISTS packages)
    if(package MATCHES "^mrpt_")
      if(TARGET rasterslam::${package})
        list(APPEND modules rasterslam_${package})
      else()
        list(REMOVE_ITEM packages ${package})  # an optional one, which was not there
      endif()
    endif()
  endforeach()
  string(APPEND RASTERSLAM_ROOM_TABLE "set(rasterslam_packages_${room} ${packages})\n")
  rasterslam_write_pkg_config(${room})
endforeach()
list(REMOVE_DUPLICATES modules)
foreach(module IN LISTS modules)
  string(REPLACE "rasterslam_" "" name ${module})
  set_target_properties(${module} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${module} EXPORT rasterslam)
endforeach()
set(RASTERSLAM_EXPORTED ${exported})

include(CMakePackageConfigHelpers)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/rasterslam)
install(EXPORT rasterslam NAMESPACE rasterslam:: FILE rasterslamTargets.cmake DESTINATION ${config} COMPONENT development)
configure_package_config_file(cmake/rasterslamConfig.cmake.in ${PROJECT_BINARY_DIR}/rasterslamConfig.cmake
  INSTALL_DESTINATION ${config} PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rasterslamConfigVersion.cmake COMPATIBILITY SameMinorVersion)
configure_file(cmake/version.h.in ${PROJECT_BINARY_DIR}/include/libslam/version.h)
install(FILES ${PROJECT_BINARY_DIR}/include/libslam/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/libslam COMPONENT development)
install(FILES ${PROJECT_BINARY_DIR}/rasterslamConfig.cmake ${PROJECT_BINARY_DIR}/rasterslamConfigVersion.cmake
              cmake/dependencies.cmake DESTINATION ${config} COMPONENT development)
install(DIRECTORY apps/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)

if(RASTERSLAM_PACKAGE)
  include(cmake/package.cmake)
endif()
