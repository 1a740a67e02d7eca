# Writes a header with a hash of the library's sources: cmake -DFOLDER=libslam -DOUTPUT=source_hash.h -P source_hash.cmake
# The order is that of the paths, so that any machine and build type gets the same hash.
file(GLOB_RECURSE sources RELATIVE ${FOLDER} ${FOLDER}/*.h ${FOLDER}/*.cpp)
list(FILTER sources EXCLUDE REGEX "^testing/")
list(SORT sources)
set(listing "")
foreach(source ${sources})
  file(SHA256 ${FOLDER}/${source} hash)
  string(APPEND listing "${hash}  ${source}\n")
endforeach()
string(SHA256 hash "${listing}")
string(SUBSTRING ${hash} 0 12 hash)
file(WRITE ${OUTPUT} "#define RASTERSLAM_SOURCE_HASH \"${hash}\"\n")
