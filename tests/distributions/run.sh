#!/usr/bin/env bash
# Tries the two commands on a clean release of Debian: makes its tree with debootstrap, clones the last commit into it, and runs
# `./bootstrap.sh demo` and `./bootstrap.sh test` there. As root; not part of the tests, for it takes half an hour and the net.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tests/distributions/run.sh RELEASE [VERB...]

  RELEASE   bookworm (Debian 12) or trixie (Debian 13)
  VERB      of ./bootstrap.sh, one after the other; demo and test unless told otherwise

The packages come from where this system's apt has its own. What is printed also goes to
build/distributions/RELEASE-VERB.log, the seconds that each took to build/distributions/RELEASE-times.txt,
what `package` makes to build/distributions/RELEASE-packages (see packages.sh).
TEXT
}

case "${1:-}" in
  bookworm | trixie) release=$1 ;;
  -h | --help) usage; exit 0 ;;
  *) echo "tests/distributions/run.sh: found '${1:-}', expected bookworm or trixie" >&2; usage >&2; exit 2 ;;
esac
shift
verbs=("$@")
[ ${#verbs[@]} -gt 0 ] || verbs=(demo test)

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/distributions/tree.sh
. "$root/tests/distributions/tree.sh"
logs=$root/build/distributions
mkdir -p "$logs"
make_tree "$release"
git clone -q "$root" "$tree/root/rasterslam"
: >"$logs/$release-times.txt"
for verb in "${verbs[@]}"; do
  begin=$SECONDS
  chroot "$tree" bash -c "cd /root/rasterslam && ./bootstrap.sh $verb" 2>&1 | tee "$logs/$release-$verb.log"
  echo "$verb $((SECONDS - begin)) s" | tee -a "$logs/$release-times.txt"
  if [ "$verb" = package ]; then
    rm -rf "$logs/$release-packages"
    cp -r "$tree/root/rasterslam/build/package/packages" "$logs/$release-packages"
  fi
done
