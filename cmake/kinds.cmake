# Static and shared libraries. Every room is built once, as the kind that BUILD_SHARED_LIBS says, which the programs link; where
# RASTERSLAM_BOTH_KINDS is on the other kind is made from the same objects as slam_<room>_twin, for those who install the library.

# What only programs of ours and tests link is never shared, nor installed.
set(RASTERSLAM_INNER_ROOMS live plugin testing)

function(rasterslam_kind_of room variable)
  if(BUILD_SHARED_LIBS AND NOT room IN_LIST RASTERSLAM_INNER_ROOMS)
    set(${variable} SHARED PARENT_SCOPE)
  else()
    set(${variable} STATIC PARENT_SCOPE)
  endif()
endfunction()

# What a shared library shows is what stands in namespace slam; all else is hidden. Its symbols carry the version that they
# came with, so that the loader refuses an older library beside a newer program, in one line.
set(RASTERSLAM_VERSION_SCRIPT ${PROJECT_BINARY_DIR}/rasterslam.map)
configure_file(${CMAKE_CURRENT_LIST_DIR}/rasterslam.map.in ${RASTERSLAM_VERSION_SCRIPT})

function(rasterslam_make_shared target)
  set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} DEFINE_SYMBOL ""
    LINKER_LANGUAGE CXX LINK_DEPENDS ${RASTERSLAM_VERSION_SCRIPT} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  target_link_options(${target} PRIVATE -Wl,--version-script=${RASTERSLAM_VERSION_SCRIPT} -Wl,--as-needed -Wl,-z,defs)
  if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")  # where the loader looks anyway
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN")
  endif()
endfunction()

# slam_<room>_twin of the rooms: each links the twins of what its room links.
function(rasterslam_add_twins)
  foreach(room IN LISTS ARGN)
    set(kind SHARED)
    if(BUILD_SHARED_LIBS)
      set(kind STATIC)
    endif()
    set(twin slam_${room}_twin)
    add_library(${twin} ${kind} $<TARGET_OBJECTS:slam_${room}>)
    set_target_properties(${twin} PROPERTIES LINKER_LANGUAGE CXX EXPORT_NAME ${room} OUTPUT_NAME rasterslam-${room}
      ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
    if(kind STREQUAL "SHARED")
      rasterslam_make_shared(${twin})
    endif()
    target_compile_features(${twin} PUBLIC cxx_std_17)
    target_include_directories(${twin} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
    get_target_property(all slam_${room} LINK_LIBRARIES)
    get_target_property(public slam_${room} INTERFACE_LINK_LIBRARIES)
    foreach(library IN LISTS all)
      string(REGEX REPLACE "^slam::(.*)$" "slam_\\1_twin" other "${library}")
      if(library IN_LIST public)
        target_link_libraries(${twin} PUBLIC ${other})
      else()
        target_link_libraries(${twin} PRIVATE ${other})
      endif()
    endforeach()
  endforeach()
endfunction()
