# Finds the components of rasterslam that the variable `components` names.
set(RASTERSLAM "@rasterslam@" CACHE PATH "where rasterslam is installed, or the build folder of a checkout that was built")
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

set(place "${RASTERSLAM}")
set(data "")
if(EXISTS "${RASTERSLAM}/cmake_install.cmake")  # a build folder: what it would install, once for all
  set(place "${RASTERSLAM}/for-projects")
  set(data "${RASTERSLAM}/data")
  file(LOCK "${RASTERSLAM}/for-projects.lock" GUARD FILE TIMEOUT 300)
  execute_process(COMMAND ${CMAKE_COMMAND} --install "${RASTERSLAM}" --prefix "${place}" --component development
                  OUTPUT_QUIET ERROR_VARIABLE said RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${RASTERSLAM}: the library is not built there; run ./bootstrap.sh build in the checkout. CMake said: ${said}")
  endif()
endif()
list(PREPEND CMAKE_PREFIX_PATH "${place}")
set(rasterslam_USE_STATIC_LIBS ON)  # a program that needs no libraries of ours beside it
find_package(rasterslam @version@ REQUIRED COMPONENTS ${components})
if(NOT data)
  set(data "${rasterslam_DATA_DIR}")
endif()
# Where worlds and methods lie that programs ask for by name.
add_compile_definitions(RASTERSLAM_DATA_FOLDER="${data}")
