# A room is one folder, one namespace slam::<name>, one target slam_<name> (alias slam::<name>).
#   slam_add_room(NAME world SOURCES a.cpp b.cpp ROOMS core LIBRARIES opencv_core)
# ROOMS and LIBRARIES are public: what a room's headers need, its users get.
add_library(slam_build_flags INTERFACE)
target_compile_options(slam_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  -ffp-contract=off)
if(RASTERSLAM_WERROR)
  target_compile_options(slam_build_flags INTERFACE -Werror)
endif()
if(RASTERSLAM_SANITIZE)
  target_compile_options(slam_build_flags INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer
                                                    -fno-sanitize-recover=undefined)
  target_link_options(slam_build_flags INTERFACE -fsanitize=address,undefined)
endif()
if(RASTERSLAM_FUZZ)
  target_compile_options(slam_build_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

function(slam_add_room)
  cmake_parse_arguments(R "" "NAME" "SOURCES;ROOMS;LIBRARIES" ${ARGN})
  set(target slam_${R_NAME})
  add_library(${target} STATIC ${R_SOURCES})
  add_library(slam::${R_NAME} ALIAS ${target})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  list(TRANSFORM R_ROOMS PREPEND slam::)
  target_link_libraries(${target} PUBLIC ${R_ROOMS} ${R_LIBRARIES} PRIVATE slam_build_flags)
endfunction()

# One test program per room: tests/<name>/*.cpp, linked with slam::<name> and slam::testing. ctest runs it suite by suite,
# longer suites by parts of CASES tests (12). One case: build/release/tests/test_<name> --gtest_filter=Suite.Case
#   slam_add_tests(world [LIBRARIES ...] [LABELS ...] [CASES n])
function(slam_add_tests name)
  cmake_parse_arguments(T "" "CASES" "LIBRARIES;LABELS" ${ARGN})
  if(NOT T_CASES)
    set(T_CASES 12)
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE slam_build_flags ${T_LIBRARIES} slam::testing
                                             GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE RASTERSLAM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                  RASTERSLAM_BINARY_DIR="${PROJECT_BINARY_DIR}")
  # The tests' own code: what they call is built as ever, and a quarter of the whole build's time is saved.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  set(listed ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_suites.cmake)
  set(script ${PROJECT_SOURCE_DIR}/cmake/list_suites.cmake)
  set_property(TARGET test_${name} APPEND PROPERTY LINK_DEPENDS ${script})
  add_custom_command(TARGET test_${name} POST_BUILD BYPRODUCTS ${listed}
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:test_${name}> -D NAME=${name} -D MOST=${T_CASES}
            -D "LABELS=${T_LABELS}" -D OUTPUT=${listed} -P ${script} VERBATIM)
  set(included ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_include.cmake)
  file(WRITE ${included} "if(EXISTS \"${listed}\")\n  include(\"${listed}\")\nelse()\n"
                         "  add_test(${name}.NOT_BUILT test_${name}_is_not_built)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${included})
endfunction()
