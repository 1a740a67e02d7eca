#!/usr/bin/env bash
# Builds the fuzzers, of every reader and of the estimators, and lets each run for a while from its seeds. Needs clang-14 and libclang-rt-14-dev.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tests/fuzz/run.sh [SECONDS [READER...]]

  SECONDS   how long each fuzzer runs (60)
  READER    which ones (all): names of the folders in tests/fuzz/corpus

An input that crashes its reader, takes more than 10 s of computing or 2 GB, or is refused otherwise than by one clear line
is kept in build/fuzz/findings/READER/. Exit code 1 when there is one.
TEXT
}
if [ "${1:-}" = --help ] || [ "${1:-}" = -h ]; then usage; exit 0; fi
seconds="${1:-60}"
shift || true
if ! [[ "$seconds" =~ ^[0-9]+$ ]]; then usage >&2; exit 2; fi

cd "$(dirname "$0")/../.."
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz >&2

readers=("$@")
if [ ${#readers[@]} -eq 0 ]; then
  for folder in tests/fuzz/corpus/*/; do readers+=("$(basename "$folder")"); done
fi

# Of the estimators' bytes 60 steps are looked at (scan_script.h); longer inputs would be changed where nobody reads.
longest() { if [ "$1" = estimators ]; then echo 256; else echo 16384; fi; }

# The rawlog's fuzzer refuses memory as a guard does in a usual build (libslam/files/memory_guard.h); what does not ask it must not
# end the program either.
export ASAN_OPTIONS="allocator_may_return_null=1:max_allocation_size_mb=600:quarantine_size_mb=16:${ASAN_OPTIONS:-}"

# What was slow by the clock (READER, FOLDER) runs again alone, and stays when it takes as much of the processor: on a busy machine a
# second's work can take a minute.
drop_hurried() {
  local input
  for input in "$2"/slow-unit-* "$2"/timeout-*; do
    if [ -e "$input" ] && (ulimit -t 12 && "build/fuzz/tests/fuzz/fuzz_$1" -timeout=600 -malloc_limit_mb=4096 "$input" >/dev/null 2>&1); then
      rm "$input"
    fi
  done
}

failed=0
printf '%-12s %10s %9s %8s  %s\n' reader runs runs/s covered result
for reader in "${readers[@]}"; do
  work="build/fuzz/grown/$reader" findings="build/fuzz/findings/$reader" log="build/fuzz/$reader.log"
  mkdir -p "$work" "$findings"
  rm -f "$findings"/*
  # To name each function when it is reached first takes longer than to run it.
  options=(-max_total_time="$seconds" -timeout=100 -rss_limit_mb=2048 -malloc_limit_mb=4096 -max_len="$(longest "$reader")"
           -print_funcs=0 -print_final_stats=1 -artifact_prefix="$findings/")
  status=0
  # A sanitizer that reports from within a crash can hang.
  timeout --kill-after=5 "$((seconds + 200))" \
    "build/fuzz/tests/fuzz/fuzz_$reader" "${options[@]}" "$work" "tests/fuzz/corpus/$reader" >"$log" 2>&1 || status=$?
  drop_hurried "$reader" "$findings"
  runs=$(grep -oE '(number_of_executed_units: |^#)[0-9]+' "$log" | grep -oE '[0-9]+' | sort -n | tail -1)
  covered=$(grep -oE 'cov: [0-9]+' "$log" | tail -1 | grep -oE '[0-9]+' || true)
  count=$(find "$findings" -type f | wc -l)
  result=clean
  if [ "$count" -gt 0 ]; then
    kinds=$(find "$findings" -type f -printf '%f\n' | sed 's/-[0-9a-f]*$//' | sort | uniq -c | sed 's/^ *//' | paste -sd, -)
    result="found: $kinds (inputs in $findings, output in $log)"
    failed=1
  elif [ "$status" -ne 0 ]; then
    result="ended with code $status, see $log"
    failed=1
  fi
  printf '%-12s %10s %9s %8s  %s\n' "$reader" "${runs:-0}" "$((${runs:-0} / (seconds > 0 ? seconds : 1)))" "${covered:-0}" "$result"
done
exit "$failed"
