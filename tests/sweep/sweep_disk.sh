#!/bin/sh
# A full disk and a read-only one: one clear line, nothing lost, --resume gives the same bytes as elsewhere.
#
#   sweep_disk.sh PROGRAM
#
# Exit code 77: no disk can be mounted here.
set -eu

if [ "${2:-}" != mounted ]; then
  unshare -m true 2> /dev/null || { echo "unshare -m is not allowed here" >&2; exit 77; }
  exec unshare -m sh "$0" "$1" mounted
fi
program=$1
. "$(dirname "$0")/sweep_common.sh"
work=$(mktemp -d)
trap 'cd /; umount "$work/disk" 2> /dev/null; rm -rf "$work"' EXIT
cd "$work"
mkdir disk plain
mount -t tmpfs -o size=96k tmpfs disk || exit 77
write_tiny_suite tiny.ini
"$program" bench tiny.ini -o plain/whole -q > /dev/null

# expect_line WORDS: the sweep fails with one line that holds them.
expect_line() {
  status=0
  "$program" bench tiny.ini -o disk/out -q --resume > /dev/null 2> errors.txt || status=$?
  [ "$status" -eq 1 ] || fail "exit code $status, expected 1: $(cat errors.txt)"
  [ "$(wc -l < errors.txt)" -eq 1 ] || fail "more than a line: $(cat errors.txt)"
  grep -q "$1" errors.txt || fail "expected '$1' in: $(cat errors.txt)"
}

expect_line 'disk/out/'
cat errors.txt
mount -o remount,size=50m,ro disk
expect_line 'Read-only file system'
cat errors.txt
mount -o remount,rw disk
"$program" bench tiny.ini -o disk/out -q --resume > /dev/null
same_sweep plain/whole disk/out || fail "the sweep differs after the disk was full"
