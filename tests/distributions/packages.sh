#!/usr/bin/env bash
# Installs the packages that `./bootstrap.sh package` made in a clean tree of their release and works there as a user would:
# the demo without a compiler, the manual, completion; then a program of one's own with librasterslam-dev. As root; not part of
# the tests, for it takes minutes and the net.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tests/distributions/packages.sh RELEASE [FOLDER]

  RELEASE   bookworm (Debian 12) or trixie (Debian 13): where the packages were made
  FOLDER    of the packages; build/package/packages unless told otherwise

What is printed also goes to build/distributions/RELEASE-installed.log, the installed sizes to RELEASE-sizes.txt there.
TEXT
}

case "${1:-}" in
  bookworm | trixie) release=$1 ;;
  -h | --help) usage; exit 0 ;;
  *) echo "tests/distributions/packages.sh: found '${1:-}', expected bookworm or trixie" >&2; usage >&2; exit 2 ;;
esac
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/distributions/tree.sh
. "$root/tests/distributions/tree.sh"
packages=${2:-$root/build/package/packages}
for name in rasterslam librasterslam0 librasterslam-dev rasterslam-doc; do
  [ -n "$(find "$packages" -name "${name}_*.deb")" ] || fail "$packages: found no package $name; ./bootstrap.sh package makes it"
done
logs=$root/build/distributions
mkdir -p "$logs"
make_tree "$release"
mkdir "$tree/packages"
cp "$packages"/*.deb "$tree/packages"

inside() { chroot "$tree" env DEBIAN_FRONTEND=noninteractive bash -euo pipefail -c "$1"; }
{
  inside 'apt-get update -qq && apt-get install -y -qq --no-install-recommends /packages/rasterslam_*.deb /packages/librasterslam0_*.deb mrpt-common >/dev/null'
  inside '! command -v c++ && ! command -v cc && ! command -v cmake' || fail "a compiler came along"
  begin=$SECONDS
  inside 'cd /tmp && rasterslam demo'
  echo "the demo took $((SECONDS - begin)) s"
  inside 'test -s /usr/share/man/man1/rasterslam.1.gz || ls /usr/share/man >&2'
  inside '. /usr/share/bash-completion/completions/rasterslam; COMP_WORDS=(rasterslam run grap); COMP_CWORD=2; _rasterslam; test "${COMPREPLY[*]}" = graph'
  inside 'test -s /usr/share/zsh/vendor-completions/_rasterslam'
  inside 'test -e "$(ldconfig -p | sed -n "s/.*librasterslam-mrpt.so.*=> //p")"'
  inside 'dpkg-query -W -f "\${Package} \${Installed-Size} KiB\n" "*rasterslam*"'
  # A program with the packages for development, which name what each component needs.
  inside 'apt-get install -y -qq --no-install-recommends /packages/*.deb g++ cmake make pkg-config >/dev/null'
  inside 'cp -r "$(find /usr/share/doc -type d -name examples -path "*rasterslam*" | head -n 1)" /tmp/examples
    cmake -S /tmp/examples -B /tmp/built -DEXAMPLES=optimise_graph >/dev/null
    cmake --build /tmp/built >/dev/null
    c++ -std=c++17 /tmp/examples/optimise_graph.cpp -o /tmp/by_pkg_config $(pkg-config --cflags --libs rasterslam-posegraph)
    printf "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n" >/tmp/a.g2o
    /tmp/built/optimise_graph /tmp/a.g2o /tmp/b.g2o
    /tmp/by_pkg_config /tmp/a.g2o /tmp/c.g2o
    cmp /tmp/b.g2o /tmp/c.g2o'
  inside 'apt-get purge -y -qq "*rasterslam*" >/dev/null; test ! -e /usr/share/rasterslam'
  echo "installed, used and removed: all as expected"
} 2>&1 | tee "$logs/$release-installed.log"
grep KiB "$logs/$release-installed.log" >"$logs/$release-sizes.txt"
