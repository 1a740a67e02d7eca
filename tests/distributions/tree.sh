# shellcheck shell=bash
# Sourced by the scripts beside it: a clean release of Debian in a folder of its own, gone when the script ends.

fail() { echo "$(basename "$0"): $*" >&2; exit 1; }

# make_tree RELEASE: sets `tree`. The packages come from where this system's apt has its own.
make_tree() {
  [ "$(id -u)" -eq 0 ] || fail "debootstrap and chroot need root"
  command -v debootstrap >/dev/null || fail "debootstrap is missing; install it"
  tree=$(mktemp -d "${TMPDIR:-/var/tmp}/rasterslam-$1-XXXXXX")
  trap clean_tree EXIT
  local mirror
  mirror=$(apt-get indextargets --format '$(REPO_URI)' | grep -v security | head -n 1)
  debootstrap --variant=minbase --include=ca-certificates,git "$1" "$tree" "$mirror"
  # How this system reaches the net; not what its packages have put there.
  local file
  for file in /etc/apt/apt.conf.d/*; do
    dpkg -S "$file" >/dev/null 2>&1 || cp "$file" "$tree/etc/apt/apt.conf.d/"
  done
  cp /etc/resolv.conf /etc/hosts "$tree/etc/"
  mount --bind /proc "$tree/proc"
  mount --bind /dev "$tree/dev"
}

clean_tree() {
  local place
  for place in dev proc; do mountpoint -q "$tree/$place" && umount -l "$tree/$place"; done
  rm -rf --one-file-system "$tree"
}
