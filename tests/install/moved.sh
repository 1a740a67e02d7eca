#!/usr/bin/env bash
# Installs a build in one folder, moves it to another and works there: the data that comes with the program is found beside
# it, and the source tree is not looked at.
#   tests/install/moved.sh BUILD_FOLDER
set -euo pipefail
build=$(realpath "$1")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
unset RASTERSLAM_DATA
fail() { echo "moved.sh: $*" >&2; exit 1; }

DESTDIR=$scratch/first cmake --install "$build" --component programs >"$scratch/install.log"
mkdir "$scratch/second"
prefix=$(dirname "$(dirname "$(find "$scratch/first" -path '*/bin/rasterslam')")")
mv "$prefix" "$scratch/second/place"
rm -rf "$scratch/first"
place=$scratch/second/place
cd "$scratch"
PATH="$place/bin:$PATH"

rasterslam simulate flat -o run.rawlog --duration 5 -q
rasterslam run icp run.rawlog -o icp -q
rasterslam compare run.rawlog -o cmp --methods naive,icp -q
rasterslam data >data.txt
# Lessons and templates came along.
rasterslam learn 6 | grep -q 'Lesson 6' || fail "learn 6 printed no page"
rasterslam learn start 6 --student 2 -o lesson -q
grep -q 'student = 2' lesson/lesson.ini || fail "learn start wrote no lesson.ini"
rasterslam new method mine -q
rasterslam plugin check mine/mine.ini run.rawlog >check.txt || fail "plugin check: $(cat check.txt)"
rasterslam list lidars | grep -q thesis_360 || fail "list lidars names no thesis_360"
test -s cmp/scores.txt || fail "compare wrote no scores.txt"
# Its helper programs and libraries came along.
for name in rasterslam-view librasterslam-mrpt.so librasterslam-sensor.so; do
  [ -z "$(find "$build" -maxdepth 2 -name "$name")" ] || [ -n "$(find "$place" -name "$name*")" ] || fail "$name was not installed"
done
if [ -n "$(find "$place" -name rasterslam-view)" ]; then rasterslam view --help >view.txt; fi
# In a program of MRPT's, which lies elsewhere, the data is found beside our library.
sensor=$(find "$place" -name librasterslam-sensor.so)
if [ -n "$sensor" ] && command -v rawlog-grabber >/dev/null; then
  mkdir grab
  sed -e 's/^scans = .*/scans = 2/' -e 's/^real_time_factor = .*/real_time_factor = 0/' \
    -e '/^scans/a done_file = done' "$place/share/rasterslam/configs/mrpt/rawlog-grabber.ini" >grab/grab.ini
  # It ends at a key; the sensor writes to `done` once it has given its scans.
  (cd grab && mkfifo done && { timeout 60 head -c 1 done | timeout 60 rawlog-grabber -p "$sensor" grab.ini; } >grab.log 2>&1) ||
    fail "rawlog-grabber: $(tail -n 3 grab/grab.log)"
  rasterslam info grab/*.rawlog >grab/info.txt
fi

expect() {
  local expected=$1 said
  shift
  said=$("$@" 2>&1 >/dev/null) && fail "$*: exit code 0, expected 3"
  [ "$(printf '%s\n' "$said" | wc -l)" -eq 1 ] || fail "$*: more than one line: $said"
  case "$said" in *"$expected"*) ;; *) fail "$*: found '$said', expected '$expected' in it" ;; esac
}
mv "$place/share/rasterslam" elsewhere
expect "is missing; looked at $place/share/rasterslam" rasterslam list worlds
RASTERSLAM_DATA=$scratch/elsewhere rasterslam list worlds | grep -q flat || fail "RASTERSLAM_DATA was not taken"
RASTERSLAM_DATA=$scratch expect "RASTERSLAM_DATA: $scratch: found no folder" rasterslam list worlds
echo 0.0.1 >elsewhere/VERSION
RASTERSLAM_DATA=$scratch/elsewhere expect "found data of version 0.0.1, expected the data of rasterslam" rasterslam list worlds
