#!/usr/bin/env bash
# Installs a build's library, moves it, and uses it from other projects: the programs of apps/examples by CMake and by
# pkg-config, each with no more packages than its components need; what is wrong is said in one line.
#   tests/install/library.sh BUILD_FOLDER
set -euo pipefail
build=$(realpath "$1")
source=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "library.sh: $*" >&2; exit 1; }
quietly() { "$@" >"$scratch/said.log" 2>&1 || { cat "$scratch/said.log" >&2; fail "$*"; }; }

cmake --install "$build" --prefix "$scratch/first" >"$scratch/install.log"
mv "$scratch/first" "$scratch/place"
place=$scratch/place
! grep -rl "$build\|$source" "$place/lib"*/cmake "$place/lib"*/pkgconfig "$place/lib"*/*/cmake "$place/lib"*/*/pkgconfig 2>/dev/null ||
  fail "the files above name the folder of the build or of the source"
cp -r "$source/apps/examples" "$scratch/examples"
cd "$scratch"

# Every example, by CMake, with the shared libraries, which find the data beside them.
unset RASTERSLAM_DATA
quietly cmake -S examples -B by_cmake -G Ninja -DCMAKE_PREFIX_PATH="$place"
quietly cmake --build by_cmake
PATH="$scratch/by_cmake:$PATH"
linked() { readelf -d "$1" | grep -c 'NEEDED.*librasterslam-' || true; }
[ "$(linked by_cmake/optimise_graph)" -gt 0 ] || fail "by_cmake/optimise_graph is not linked with the shared libraries"
quietly simulate_and_map
mapped=$(grep -o 'x -*[0-9.]* m, y -*[0-9.]* m' said.log)
for file in map.yaml map.png map.gridmap.gz map.simplemap; do test -s "$file" || fail "simulate_and_map wrote no $file"; done
quietly match_scans
quietly cast_in_grid
grep -q 'straight ahead 2.000 m' said.log || fail "cast_in_grid: $(cat said.log)"
quietly cast_in_grid map.gridmap.gz
quietly localise_in_map map.simplemap run.rawlog
# Where the map was made the robot ended there, too; each is right to a centimetre.
found=$(grep -o 'x -*[0-9.]* m, y -*[0-9.]* m' said.log)
awk -v a="$mapped $found" 'BEGIN { split(a, w, " "); if ((w[2] - w[8])^2 + (w[5] - w[11])^2 > 0.02^2) exit 1 }' ||
  fail "localise_in_map ends at $found, simulate_and_map at $mapped"
quietly own_method
grep -q '^own ' said.log || fail "own_method: $(cat said.log)"

# A square of four edges whose last closes it: its chi2 falls.
cat >square.g2o <<'TEXT'
VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1 0 1.6
VERTEX_SE2 2 1 1 3.1
VERTEX_SE2 3 0 1.1 -1.6
EDGE_SE2 0 1 1 0 1.5708 100 0 0 100 0 400
EDGE_SE2 1 2 1 0 1.5708 100 0 0 100 0 400
EDGE_SE2 2 3 1 0 1.5708 100 0 0 100 0 400
EDGE_SE2 0 3 0 1 -1.5708 100 0 0 100 0 400
TEXT
quietly optimise_graph square.g2o by_cmake.g2o

# Two of them with the static libraries: the same results, and nothing of ours to load.
quietly cmake -S examples -B static -G Ninja -DCMAKE_PREFIX_PATH="$place" -Drasterslam_USE_STATIC_LIBS=ON \
  -DEXAMPLES="optimise_graph;localise_in_map"
quietly cmake --build static
for example in optimise_graph localise_in_map; do
  [ "$(linked static/$example)" -eq 0 ] || fail "static/$example is linked with shared libraries of ours"
done
quietly static/optimise_graph square.g2o static.g2o
cmp by_cmake.g2o static.g2o
quietly localise_in_map map.simplemap run.rawlog
cp said.log shared.log
RASTERSLAM_DATA=$place/share/rasterslam quietly static/localise_in_map map.simplemap run.rawlog
cmp shared.log said.log

# Two of them by pkg-config: one that needs Eigen alone, one with MRPT and OpenCV.
pc=$(dirname "$(find "$place" -name rasterslam-posegraph.pc)")
for example in optimise_graph:posegraph localise_in_map:"mapping rasterslam-logs"; do
  flags=$(PKG_CONFIG_PATH=$pc pkg-config --cflags --libs rasterslam-${example#*:})
  # shellcheck disable=SC2086  # words
  quietly c++ -std=c++17 "examples/${example%%:*}.cpp" -o "pc_${example%%:*}" $flags ${LDFLAGS:-}
done
libraries=$(dirname "$(find "$place" -name librasterslam-core.so)")
export LD_LIBRARY_PATH=$libraries
quietly ./pc_optimise_graph square.g2o by_pkg_config.g2o
cmp by_cmake.g2o by_pkg_config.g2o
quietly ./pc_localise_in_map map.simplemap run.rawlog

# An older library beside a newer program is refused by the loader, in one line.
mkdir older
sed 's/RASTERSLAM_[0-9.]*/RASTERSLAM_0.1/' "$build/rasterslam.map" >older.map
quietly c++ -shared -o older/librasterslam-posegraph.so.0 -Wl,-soname,librasterslam-posegraph.so.0 -Wl,--version-script=older.map \
  -Wl,--whole-archive "$libraries/librasterslam-posegraph.a" -Wl,--no-whole-archive -L"$libraries" -lrasterslam-files -lrasterslam-core ${LDFLAGS:-}
! LD_LIBRARY_PATH=$scratch/older:$libraries ./pc_optimise_graph square.g2o older.g2o 2>said.log || fail "an older library was taken"
if [ "$(wc -l <said.log)" -ne 1 ] || ! grep -q "librasterslam-posegraph.so.0: version .RASTERSLAM_[0-9.]*' not found" said.log; then
  fail "an older library: found '$(cat said.log)', expected one line that names it and the version"
fi
unset LD_LIBRARY_PATH

# What `rasterslam new` writes builds with the copy that the program lies in, runs and passes its test as it is.
mkdir begun
(
  cd begun
  unset RASTERSLAM_DATA
  "$place/bin/rasterslam" simulate flat -o run.rawlog --duration 5 -q
  for kind in "method my_method --language cpp" "strategy my_strategy" "navigator my_navigator"; do
    name=${kind#* } && name=${name%% *}
    # shellcheck disable=SC2086  # words
    "$place/bin/rasterslam" new $kind -q
    grep -q "RASTERSLAM \"$place\"" "$name/find_rasterslam.cmake" || fail "$name: looks for the library elsewhere than in $place"
    quietly cmake -S "$name" -B "$name/build" -G Ninja
    quietly cmake --build "$name/build"
    quietly ctest --test-dir "$name/build"
  done
  quietly "$place/bin/rasterslam" plugin check my_method/my_method.ini run.rawlog
  quietly my_strategy/build/my_strategy flat explored 1 20
  grep -q my_strategy ../said.log || fail "my_strategy has no row"
  quietly my_navigator/build/my_navigator pillar_hall 16,10 driven
  grep -q my_navigator ../said.log || fail "my_navigator has no row"
)

# Eigen is all that posegraph asks for, installed and as a part of another project.
others=()
for package in OpenCV OpenSSL yaml-cpp ZLIB BZip2 LibLZMA PkgConfig SQLite3 Threads Boost nlohmann_json CLI11 GTest \
  mrpt-obs mrpt-maps mrpt-slam; do others+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
quietly cmake -S examples -B eigen_alone -G Ninja -DCMAKE_PREFIX_PATH="$place" -DEXAMPLES=optimise_graph "${others[@]}"
mkdir subproject
cat >subproject/CMakeLists.txt <<TEXT
cmake_minimum_required(VERSION 3.20)
project(subproject LANGUAGES CXX)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(RASTERSLAM_COMPONENTS posegraph CACHE STRING "")
add_subdirectory($source rasterslam)
add_executable(optimise_graph $source/apps/examples/optimise_graph.cpp)
target_link_libraries(optimise_graph PRIVATE rasterslam::posegraph)
TEXT
quietly cmake -S subproject -B subproject/build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 "${others[@]}"
commands=subproject/build/compile_commands.json
grep -q -- '-O1' $commands || fail "the flags of the project around were overwritten"
! grep -q -- '-Werror\|-O2' $commands || fail "the project around got flags of ours"

# What is wrong is one line of the message, and the configuration ends.
refused() {
  local expected=$1
  shift
  ! cmake "$@" >said.log 2>&1 || fail "cmake $*: succeeded, expected: $expected"
  tr -s ' \n' ' ' <said.log | grep -qF "$expected" || { cat said.log >&2; fail "cmake $*: said not: $expected"; }
}
mkdir user
cat >user/CMakeLists.txt <<'TEXT'
cmake_minimum_required(VERSION 3.20)
project(user LANGUAGES CXX)
find_package(rasterslam REQUIRED COMPONENTS ${WANTED})
TEXT
refused "component 'maping': no such, expected some of" -S user -B user/1 -DCMAKE_PREFIX_PATH="$place" -DWANTED=maping
refused "need OpenCV, which was not found" -S user -B user/2 -DCMAKE_PREFIX_PATH="$place" -DWANTED=world -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON
refused "RASTERSLAM_COMPONENTS: found 'maping', expected some of" -S subproject -B subproject/2 -DRASTERSLAM_COMPONENTS=maping
echo '#define RASTERSLAM_HEADERS_VERSION "0.1.9"' >"$place/include/libslam/version.h"
refused 'found headers of version "0.1.9", expected those of the libraries' -S user -B user/3 -DCMAKE_PREFIX_PATH="$place" -DWANTED=posegraph
