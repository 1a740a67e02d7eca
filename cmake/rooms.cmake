# A room is one folder, one namespace slam::<name>, one target slam_<name> (alias slam::<name>).
#   slam_add_room([PLAIN] NAME world SOURCES a.cpp b.cpp ROOMS core LIBRARIES opencv_core [APART b.cpp])
# PLAIN: it reads, calls others and writes, and is not worth the time that -O2 takes over it.
# ROOMS and LIBRARIES are public: what a room's headers need, its users get.
# Where CMAKE_UNITY_BUILD is on (preset release) up to 8 sources are compiled as one, in half the time. Of two sources of a
# target that both have a name for themselves, one is compiled APART.
add_library(slam_build_flags INTERFACE)
target_compile_options(slam_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  -ffp-contract=off)
if(RASTERSLAM_WERROR)
  target_compile_options(slam_build_flags INTERFACE -Werror)
endif()
# From 128 MB on gcc looks again and again for what it needs no more, which takes a twelfth of its time.
target_compile_options(slam_build_flags INTERFACE "$<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-heapsize=768000>")
if(CMAKE_UNITY_BUILD)
  # gcc spares a .cpp this warning, but not one that it meets as part of another file.
  target_compile_options(slam_build_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
set(slam_patience 1)  # limits of time in tests are for programs without sanitizers
if(RASTERSLAM_SANITIZE)
  set(slam_patience 5)
endif()
if(RASTERSLAM_SANITIZE STREQUAL "threads")
  target_compile_options(slam_build_flags INTERFACE -O1 -fsanitize=thread -fno-omit-frame-pointer)
  target_link_options(slam_build_flags INTERFACE -fsanitize=thread)
  set(slam_test_environment "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/threads.supp:halt_on_error=1")
elseif(RASTERSLAM_SANITIZE)
  # Not optimised at all, the tests of the estimators take hours.
  target_compile_options(slam_build_flags INTERFACE -O1 -fsanitize=address,undefined -fno-omit-frame-pointer
                                                    -fno-sanitize-recover=undefined)
  # With sanitizers gcc takes parts of std::function in std::regex for uninitialised (its manual says that it may).
  target_compile_options(slam_build_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(slam_build_flags INTERFACE -fsanitize=address,undefined)
  set(slam_test_environment "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks.supp:print_suppressions=0")
endif()
if(RASTERSLAM_FUZZ)
  target_compile_options(slam_build_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# The rooms that a room stands on and the packages behind what it links, both direct, from its CMakeLists.txt.
function(rasterslam_read_room room rooms_variable packages_variable)
  set(rooms "")
  set(packages "")
  set(file ${PROJECT_SOURCE_DIR}/libslam/${room}/CMakeLists.txt)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  if(text MATCHES "ROOMS([a-z \n]+)")
    string(REGEX MATCHALL "[a-z]+" rooms "${CMAKE_MATCH_1}")
  endif()
  foreach(pair IN LISTS RASTERSLAM_PACKAGE_OF)
    string(REGEX MATCH "^(.*)=(.*)$" ignored "${pair}")
    set(begin "${CMAKE_MATCH_1}")
    set(package "${CMAKE_MATCH_2}")
    string(FIND "${text}" "${begin}" found)
    if(found GREATER -1)
      list(APPEND packages ${package})
    endif()
  endforeach()
  string(REGEX MATCHALL "rasterslam::mrpt_[a-z0-9]+" modules "${text}")
  list(TRANSFORM modules REPLACE "^rasterslam::" "")
  list(APPEND packages ${modules})
  list(REMOVE_DUPLICATES packages)
  set(${rooms_variable} "${rooms}" PARENT_SCOPE)
  set(${packages_variable} "${packages}" PARENT_SCOPE)
endfunction()

# The rooms named and all that they stand on, in the order in which they are built, and every package that these need.
function(rasterslam_close_rooms wanted rooms_variable packages_variable)
  set(reached ${wanted})
  set(packages "")
  set(todo ${wanted})
  while(todo)
    list(POP_FRONT todo room)
    rasterslam_read_room(${room} below needed)
    list(APPEND packages ${needed})
    foreach(other IN LISTS below)
      if(NOT other IN_LIST reached)
        list(APPEND reached ${other})
        list(APPEND todo ${other})
      endif()
    endforeach()
  endwhile()
  list(REMOVE_DUPLICATES packages)
  set(${rooms_variable} "${reached}" PARENT_SCOPE)
  set(${packages_variable} "${packages}" PARENT_SCOPE)
endfunction()

function(rasterslam_compile_apart)
  foreach(source IN LISTS ARGN)
    if(NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source})
      message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR}: APART names ${source}, which is not there")
    endif()
  endforeach()
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(slam_add_room)
  cmake_parse_arguments(R "PLAIN" "NAME" "SOURCES;ROOMS;LIBRARIES;APART" ${ARGN})
  set(target slam_${R_NAME})
  rasterslam_compile_apart(${R_APART})
  rasterslam_kind_of(${R_NAME} kind)
  add_library(${target} ${kind} ${R_SOURCES})
  add_library(slam::${R_NAME} ALIAS ${target})
  add_library(rasterslam::${R_NAME} ALIAS ${target})  # as an installed copy calls it
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${R_NAME} OUTPUT_NAME rasterslam-${R_NAME})
  if(kind STREQUAL "SHARED")
    rasterslam_make_shared(${target})
  endif()
  target_compile_features(${target} PUBLIC cxx_std_17)
  if(R_PLAIN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  list(TRANSFORM R_ROOMS PREPEND slam::)
  target_link_libraries(${target} PUBLIC ${R_ROOMS} ${R_LIBRARIES} PRIVATE $<BUILD_INTERFACE:slam_build_flags>)
endfunction()

# One test program per room: tests/<name>/*.cpp, linked with slam::<name> and slam::testing. ctest runs it by parts of CASES
# tests (24). One case: build/release/tests/test_<name> --gtest_filter=Suite.Case
# Suites that are LONG are run by ./bootstrap.sh long.
# The tests' own code is not optimised: what they call is built as ever. COMPUTING: they compute much themselves.
#   slam_add_tests(world [COMPUTING] [LIBRARIES ...] [LONG Suite ...] [CASES n] [APART world/a_test.cpp])
function(slam_add_tests name)
  cmake_parse_arguments(T "COMPUTING" "CASES" "LIBRARIES;LONG;APART" ${ARGN})
  if(NOT T_CASES)
    set(T_CASES 24)
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  rasterslam_compile_apart(${T_APART})
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE slam_build_flags ${T_LIBRARIES} slam::testing
                                             GTest::gtest GTest::gmock GTest::gtest_main)
  if(TARGET rasterslam_same_bits AND NOT RASTERSLAM_SANITIZE)  # golden hashes of what MRPT gives hold on every processor
    target_link_libraries(test_${name} PRIVATE rasterslam_same_bits)
  endif()
  target_compile_definitions(test_${name} PRIVATE RASTERSLAM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                  RASTERSLAM_BINARY_DIR="${PROJECT_BINARY_DIR}")
  if(T_COMPUTING)
    target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  else()
    target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O0>)
  endif()
  math(EXPR timeout "480 * ${slam_patience}")
  list(JOIN T_LONG " " long)
  set(listed ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_suites.cmake)
  set(script ${PROJECT_SOURCE_DIR}/cmake/list_suites.cmake)
  set_property(TARGET test_${name} APPEND PROPERTY LINK_DEPENDS ${script})
  add_custom_command(TARGET test_${name} POST_BUILD BYPRODUCTS ${listed}
    COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:test_${name}> -D NAME=${name} -D MOST=${T_CASES}
            -D "LONG=${long}" -D TIMEOUT=${timeout} -D "ENVIRONMENT=${slam_test_environment}"
            -D OUTPUT=${listed} -P ${script} VERBATIM)
  set(included ${CMAKE_CURRENT_BINARY_DIR}/test_${name}_include.cmake)
  file(WRITE ${included} "if(EXISTS \"${listed}\")\n  include(\"${listed}\")\nelse()\n"
                         "  add_test(${name}.NOT_BUILT test_${name}_is_not_built)\nendif()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${included})
endfunction()
