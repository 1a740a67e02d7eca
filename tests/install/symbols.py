#!/usr/bin/env python3
"""What the shared libraries show: nothing but namespace slam, under the version that they came with, and all that was there
when symbols.txt was written. A symbol that is gone breaks programs that were linked before: bump the library's version or
keep it; what is new is no fault.

  tests/install/symbols.py BUILD_FOLDER            compare with symbols.txt
  tests/install/symbols.py BUILD_FOLDER --write    write symbols.txt anew
"""
import pathlib
import re
import subprocess
import sys

LIST = pathlib.Path(__file__).with_name("symbols.txt")
# Functions and data that are strong: which inline ones appear is the compiler's choice.
STRONG = set("TDBR")
# What differs between the releases of Debian: the class of resources/json_entry.h, which is not installed, and what a macro of MRPT's
# defines.
OTHERS = re.compile(r"nlohmann::|::runtimeClassId$")
OURS = re.compile(r"_Z(?:N|NK|TVN|TTN|TIN|TSN|ZN|ZNK|GVZN|GVZNK|GVN|T[hv].*_NK?)4slam")


def shown(library):
    """(kind, mangled name, version) of every symbol that the library defines for others."""
    text = subprocess.run(["nm", "-D", "--defined-only", "--with-symbol-versions", str(library)],
                          check=True, capture_output=True, text=True).stdout
    for line in text.splitlines():
        words = line.split()
        name, _, version = words[-1].partition("@")
        if words[-2] != "A":  # the version itself
            yield words[-2], name, version.lstrip("@")


def demangled(names):
    text = subprocess.run(["c++filt"], input="\n".join(names), check=True, capture_output=True, text=True).stdout
    return text.splitlines()


def main():
    build = pathlib.Path(sys.argv[1])
    version = re.search(r"RASTERSLAM_[0-9.]+", (build / "rasterslam.map").read_text()).group()
    libraries = sorted(path for path in (build / "lib").glob("librasterslam-*.so") if path.is_symlink())
    if not libraries:
        sys.exit(f"symbols.py: {build}/lib: found no shared library, expected those of the rooms")
    faults, found = [], []
    for library in libraries:
        room = library.stem[len("librasterslam-"):]
        soname = re.search(r"SONAME.*\[(.*)\]", subprocess.run(["readelf", "-d", str(library)], check=True,
                                                              capture_output=True, text=True).stdout).group(1)
        if not re.fullmatch(rf"librasterslam-{room}\.so\.\d+", soname):
            faults.append(f"{library.name}: found the name {soname}, expected one that ends in .so and a number")
        symbols = list(shown(library))
        faults += [f"{room}: {name} is shown, but is not in namespace slam" for _, name, _ in symbols
                   if not OURS.match(name)]
        faults += [f"{room}: {name} has the version '{has}', expected {version}" for _, name, has in symbols
                   if has != version]
        names = demangled([name for kind, name, _ in symbols if kind in STRONG])
        found += [f"{room} {name}" for name in names if not OTHERS.search(name)]
    found = sorted(set(found))
    if "--write" in sys.argv:
        LIST.write_text("\n".join(found) + "\n")
    else:
        gone = sorted(set(LIST.read_text().splitlines()) - set(found))
        faults += [f"{symbol}: is gone; where that is meant: tests/install/symbols.py BUILD_FOLDER --write" for symbol in gone]
    for fault in faults[:20]:
        print(f"symbols.py: {fault}", file=sys.stderr)
    if len(faults) > 20:
        print(f"symbols.py: and {len(faults) - 20} more", file=sys.stderr)
    print(f"{len(libraries)} libraries show {len(found)} symbols")
    sys.exit(1 if faults else 0)


main()
