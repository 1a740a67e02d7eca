# `cpack` in the build folder makes Debian packages: rasterslam, librasterslam0, librasterslam-dev, rasterslam-doc.
# `./bootstrap.sh package`
# builds for /usr first, so that everything lies where Debian has it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rasterslam)
set(CPACK_PACKAGE_VENDOR "the rasterslam authors")
set(RASTERSLAM_MAINTAINER "the rasterslam authors <authors@rasterslam.invalid>" CACHE STRING "of the packages: NAME <ADDRESS>")
set(CPACK_PACKAGE_CONTACT ${RASTERSLAM_MAINTAINER})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL programs libraries development documentation)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(about "rasterslam simulates a robot with a laser scanner in a floor plan,
maps its logs (or yours) with several SLAM methods, and scores the maps
against the truth.")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME rasterslam)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "mrpt-apps, fonts-liberation")
# The plug-ins lie where the loader looks.
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION "2D-lidar SLAM: simulate, map, score\n${about}")
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_NAME librasterslam${PROJECT_VERSION_MAJOR})
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_SHLIBDEPS ON)
# The data is the programs' package; libraries and programs of one version are one.
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_SUGGESTS "rasterslam (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
set(CPACK_COMPONENT_LIBRARIES_DESCRIPTION "2D-lidar SLAM: shared libraries\n${about}\n These are its rooms as shared libraries.")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "librasterslam${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME librasterslam-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "librasterslam${PROJECT_VERSION_MAJOR} (= ${PROJECT_VERSION}), libeigen3-dev")
# Each component wants its own of these; find_package says which is missing.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "rasterslam (= ${PROJECT_VERSION}), libmrpt-dev, libopencv-dev, libssl-dev, libyaml-cpp-dev, zlib1g-dev, libbz2-dev, liblzma-dev, liblz4-dev, libzstd-dev, libsqlite3-dev, libcairo2-dev, pkgconf")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "2D-lidar SLAM: headers and libraries\n${about}\n These are its rooms as C++ libraries.")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME rasterslam-doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_DOCUMENTATION_DESCRIPTION "2D-lidar SLAM: documentation\n${about}\n These are its pages of documentation.")

# What Debian wants in every package.
file(READ LICENSE license)
string(REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license "${license}")
file(WRITE ${PROJECT_BINARY_DIR}/debian/copyright
  "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: rasterslam\n\nFiles: *\nCopyright: the rasterslam authors\nLicense: BSD-3-Clause\n ${license}\n")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${PROJECT_BINARY_DIR}/debian/changelog
  "rasterslam (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * See CHANGELOG.md in rasterslam-doc.\n\n -- ${RASTERSLAM_MAINTAINER}  ${date}\n")
find_program(RASTERSLAM_GZIP gzip REQUIRED)
execute_process(COMMAND ${RASTERSLAM_GZIP} -9nc ${PROJECT_BINARY_DIR}/debian/changelog OUTPUT_FILE ${PROJECT_BINARY_DIR}/debian/changelog.gz)
foreach(pair programs=rasterslam libraries=librasterslam${PROJECT_VERSION_MAJOR} development=librasterslam-dev documentation=rasterslam-doc)
  string(REGEX MATCH "^(.*)=(.*)$" ignored ${pair})
  install(FILES ${PROJECT_BINARY_DIR}/debian/copyright ${PROJECT_BINARY_DIR}/debian/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_2} COMPONENT ${CMAKE_MATCH_1})
endforeach()
include(CPack)
