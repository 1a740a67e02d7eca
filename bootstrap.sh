#!/usr/bin/env bash
# Sets rasterslam up on Debian 12 or 13 and does one job. See ./bootstrap.sh --help.
set -euo pipefail
cd "$(dirname "$0")"

usage() {
  cat <<'TEXT'
usage: ./bootstrap.sh VERB [--no-install] [ARGUMENTS...]

  build    install what is missing, configure and build (build/release)
  demo     build, then simulate a robot, run the SLAM methods, print the table (ARGUMENTS go to `rasterslam demo`)
  test     build, then run the tests, but for those that take long (ARGUMENTS go to ctest)
  long     build, then run the tests that take long: whole commands, every command that README and documentation print, the
           lessons, an installed copy, sweeps under kills, calls of the system that fail (ARGUMENTS go to ctest)
  bench    build with benchmarks, then run them (ARGUMENTS go to the benchmark)
  schedulers   install GNU parallel and Slurm, with which `test` then tries sweeps (without: those tests skip)
  page     install Node.js and Chromium, make the HTML report's bundle; `test` then tries the report in the browser
  page test    check that the bundle that is checked in is current, build, and try the report in the browser
  package  make the Debian packages rasterslam, librasterslam0, librasterslam-dev and rasterslam-doc in build/package/packages,
           and check them
  docs     make the documentation as an offline site and the reference of the headers, in build/docs
  clang    build everything with clang, and run all tests
  sanitize build everything with address and undefined-behaviour sanitizers, and run all tests (an hour and more)
  threads  build the tests of what uses threads with the thread sanitizer, and run them
  tidy     clang-tidy over every source file (an hour and more)
  attack   build, then damage files of every format, give every key odd values, and fail every call of the system once in every command
           (ARGUMENTS go to tests/fuzz/campaign.py)
  fuzz     build every reader of files, and the estimators, with clang's fuzzer and let each run a minute (ARGUMENTS go to tests/fuzz/run.sh)

  --no-install   do not install packages (for users without root); says what is missing and goes on

Packages come from Debian with apt-get, as root or through sudo. Everything else stays in this folder.
TEXT
}

# What the code needs to build and test. `command -v`-like checks would miss headers, so dpkg is asked.
packages=(
  g++ cmake make ninja-build pkg-config
  libmrpt-dev mrpt-apps mrpt-common
  libopencv-dev libeigen3-dev libboost-dev libcli11-dev nlohmann-json3-dev libssl-dev zlib1g-dev libbz2-dev liblzma-dev
  liblz4-dev libzstd-dev libsqlite3-dev libyaml-cpp-dev libcairo2-dev fonts-liberation
  libgtest-dev libgmock-dev bzip2 xz-utils procps python3 xvfb xauth xdotool
)
# Debian 12's; where there is another one the test of the formatting is left out.
format_packages=(clang-format-14)
bench_packages=(libbenchmark-dev)
# ROS's own libraries, with which tests compare ours, and a shell that they complete words in; those tests skip where Debian no
# longer has them.
oracle_packages=(zsh librosbag-storage-dev libroscpp-core-dev libsensor-msgs-dev libnav-msgs-dev libtf2-msgs-dev libfastcdr-dev)
# Schedulers that tests of sweeps start when they are there, and skip otherwise.
scheduler_packages=(parallel slurmctld slurmd slurm-client munge)
# What makes the HTML report's bundle, and the browser that tests open it in; without them those tests skip.
page_packages=(chromium)
# Node.js from elsewhere brings an npm of its own, beside which Debian's cannot be installed.
command -v npm >/dev/null || page_packages+=(nodejs npm)
docs_packages=(mkdocs doxygen)
package_packages=(dpkg-dev file lintian)
clang_packages=(clang-14)
tidy_packages=(clang-tidy-14)
fuzz_packages=(clang-14 libclang-rt-14-dev)

say() { printf 'bootstrap: %s\n' "$*" >&2; }

missing_packages() {
  local name
  for name in "$@"; do
    dpkg-query -W -f='${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed || printf '%s\n' "$name"
  done
}

install_missing() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  if [ ${#missing[@]} -eq 0 ]; then return; fi
  if [ "$install" = no ]; then
    say "not installed, and --no-install was given: ${missing[*]}"
    return
  fi
  if ! command -v apt-get >/dev/null; then
    say "this is not a Debian system; install these yourself and use --no-install: ${missing[*]}"
    exit 1
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { say "root or sudo is needed to install: ${missing[*]} (or --no-install)"; exit 1; }
    as_root=(sudo)
  fi
  say "installing: ${missing[*]}"
  # A fresh machine may be at its own updates: wait for them.
  local wait=(-o DPkg::Lock::Timeout=900)
  "${as_root[@]}" apt-get "${wait[@]}" update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "${wait[@]}" install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# Of the packages named, those that this release of Debian has.
available_packages() {
  local name
  for name in "$@"; do
    [ -z "$(apt-cache madison "$name" 2>/dev/null)" ] || printf '%s\n' "$name"
  done
}

# The configure preset, how long it takes the first time, and the build preset where that has another name.
build() {
  say "building (about $2 minutes on 2 cores the first time)"
  cmake --preset "$1" >&2
  cmake --build --preset "${3:-$1}" >&2
}

verb=""
install=yes
arguments=()
for word in "$@"; do
  case "$word" in
    --no-install) install=no ;;
    -h | --help) if [ -z "$verb" ]; then usage; exit 0; fi; arguments+=("$word") ;;
    *) if [ -z "$verb" ]; then verb="$word"; else arguments+=("$word"); fi ;;
  esac
done

case "$verb" in
  build)
    install_missing "${packages[@]}"
    build release 7 programs
    say "the program is build/release/apps/rasterslam"
    ;;
  demo)
    install_missing "${packages[@]}"
    build release 7 programs
    build/release/apps/rasterslam demo "${arguments[@]}"
    ;;
  test | long)
    install_missing "${packages[@]}"
    mapfile -t extras < <(available_packages "${format_packages[@]}" "${oracle_packages[@]}")
    install_missing "${extras[@]}"
    build release 15
    which=(-LE '^long$')
    if [ "$verb" = long ]; then which=(-L '^long$'); fi
    ctest --preset release -j "$(nproc)" "${which[@]}" "${arguments[@]}"
    ;;
  schedulers)
    install_missing "${scheduler_packages[@]}"
    ;;
  page)
    if [ "${arguments[*]}" != "" ] && [ "${arguments[*]}" != test ]; then
      say "page: found '${arguments[*]}', expected test or nothing"
      exit 2
    fi
    install_missing "${page_packages[@]}"
    (cd libslam/report/page && npm ci --ignore-scripts --no-fund --no-audit)
    if [ "${arguments[*]}" = test ]; then
      install_missing "${packages[@]}"
      # Here what ctest would skip is an error.
      tests/report/page/bundle.sh
      build release 4 programs
      tests/report/page/browser.sh "$PWD/build/release/apps/rasterslam"
    else
      (cd libslam/report/page && npm run build)
    fi
    ;;
  bench)
    install_missing "${packages[@]}" "${bench_packages[@]}"
    build bench 15
    build/release/benchmarks/rasterslam_bench "${arguments[@]}"
    ;;
  package)
    install_missing "${packages[@]}" "${package_packages[@]}"
    build package 7
    (cd build/package && cpack >&2)
    lintian --fail-on error build/package/packages/*.deb
    say "install them with: apt-get install ./build/package/packages/*.deb"
    ;;
  docs)
    install_missing "${docs_packages[@]}"
    tests/docs/links.py
    mkdir -p build/docs
    .github/docs/site.py build/docs-pages
    mkdocs build -q -f .github/docs/mkdocs.yml
    doxygen .github/docs/Doxyfile
    say "open build/docs/site/index.html and build/docs/api/index.html"
    ;;
  clang)
    install_missing "${packages[@]}" "${clang_packages[@]}"
    build clang 15
    ctest --preset clang -j "$(nproc)" "${arguments[@]}"
    ;;
  sanitize)
    install_missing "${packages[@]}"
    build debug 40
    ctest --preset debug -j "$(nproc)" "${arguments[@]}"
    ;;
  threads)
    install_missing "${packages[@]}"
    build threads 30
    ctest --preset threads -j "$(nproc)" "${arguments[@]}"
    ;;
  tidy)
    install_missing "${packages[@]}" "${tidy_packages[@]}"
    build tidy 60
    ;;
  fuzz)
    install_missing "${packages[@]}" "${fuzz_packages[@]}"
    tests/fuzz/run.sh "${arguments[@]}"
    ;;
  attack)
    install_missing "${packages[@]}"
    build release 7 programs
    cmake --build --preset release --target rasterslam_faults >&2
    attacked=0
    tests/fuzz/campaign.py build/release/apps/rasterslam "${arguments[@]}" || attacked=1
    tests/fuzz/extremes.py build/release/apps/rasterslam || attacked=1
    tests/faults/faults.py build/release/apps/rasterslam build/release/tests/librasterslam_faults.so || attacked=1
    exit "$attacked"
    ;;
  "")
    usage
    exit 2
    ;;
  *)
    say "unknown verb '$verb'"
    usage >&2
    exit 2
    ;;
esac
