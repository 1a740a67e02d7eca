# rasterslam-<room>.pc, for `pkg-config --cflags --libs rasterslam-<room>`.

# The libraries behind a target of MRPT's, itself first.
function(rasterslam_mrpt_libraries target variable)
  set(libraries ${${variable}})
  string(REGEX REPLACE "^mrpt::(mrpt_)?" "" name ${target})
  if(TARGET ${target} AND NOT "-lmrpt-${name}" IN_LIST libraries)
    get_target_property(kind ${target} TYPE)
    if(NOT kind STREQUAL "INTERFACE_LIBRARY")
      list(APPEND libraries -lmrpt-${name})
    endif()
    get_target_property(below ${target} INTERFACE_LINK_LIBRARIES)
    foreach(other IN LISTS below)
      if(other MATCHES "^mrpt::")
        rasterslam_mrpt_libraries(${other} libraries)
      endif()
    endforeach()
  endif()
  set(${variable} "${libraries}" PARENT_SCOPE)
endfunction()

function(rasterslam_write_pkg_config room)
  rasterslam_read_room(${room} below packages)
  set(requires "")
  foreach(other IN LISTS below)
    list(APPEND requires rasterslam-${other})
  endforeach()
  set(libraries -lrasterslam-${room})
  set(flags "")
  foreach(pair OpenCV=opencv4 Eigen3=eigen3 OpenSSL=libcrypto yaml-cpp=yaml-cpp ZLIB=zlib LibLZMA=liblzma LZ4=liblz4 ZSTD=libzstd
               CAIRO=cairo SQLite3=sqlite3)
    string(REGEX MATCH "^(.*)=(.*)$" ignored ${pair})
    if(CMAKE_MATCH_1 IN_LIST packages)
      list(APPEND requires ${CMAKE_MATCH_2})
    endif()
  endforeach()
  if(BZip2 IN_LIST packages)
    list(APPEND libraries -lbz2)
  endif()
  if(Threads IN_LIST packages)
    list(APPEND libraries -pthread)
  endif()
  foreach(package IN LISTS packages)
    if(package MATCHES "^mrpt_(.*)$" AND TARGET rasterslam::${package})
      get_target_property(behind rasterslam_${package} INTERFACE_LINK_LIBRARIES)
      rasterslam_mrpt_libraries(${behind} libraries)
      string(APPEND flags " -isystem$<JOIN:$<FILTER:$<REMOVE_DUPLICATES:$<TARGET_PROPERTY:rasterslam_${package},INTERFACE_INCLUDE_DIRECTORIES>>,EXCLUDE,^/usr/include$>, -isystem>")
    endif()
  endforeach()
  list(JOIN requires ", " requires)
  list(JOIN libraries " " libraries)
  # Where it lies says where the rest lies, so that a moved copy is found, too.
  file(RELATIVE_PATH up ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/pkgconfig/rasterslam-${room}.pc CONTENT "prefix=\${pcfiledir}/${up}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}

Name: rasterslam-${room}
Description: ${PROJECT_DESCRIPTION}: room ${room}
Version: ${PROJECT_VERSION}
Requires: ${requires}
Libs: -L\${libdir} ${libraries}
Cflags: -I\${includedir}${flags}
")
  install(FILES ${PROJECT_BINARY_DIR}/pkgconfig/rasterslam-${room}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()
