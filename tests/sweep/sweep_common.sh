# For the scripts beside this one: a tiny sweep, and whether two sweeps' folders hold the same. To be sourced.

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# Two logs of five seconds with two methods on each: six cells.
write_tiny_suite() {
  printf '%s\n' '[suite]' 'worlds = flat' 'methods = naive_wheel, naive' 'seeds = 1..2' \
    '[lidar]' 'beams = 61' '[simulation]' 'duration_s = 5' > "$1"
}

# Everything but time and memory.
same_sweep() {
  diff -r --exclude='cost*' --exclude=manifest.json --exclude=run.manifest.json --exclude=stderr.txt \
    --exclude=submit "$1" "$2"
}
