#!/usr/bin/env python3
"""Every page with a command block that can be run is one of those that tests/CMakeLists.txt hands to run_blocks.py.

Exit code 1 and one line per page that is not.
"""
import re
import sys

import run_blocks


def main():
    listed = re.search(r"foreach\(page ([^)]*)\)", (run_blocks.ROOT / "tests" / "CMakeLists.txt").read_text(encoding="utf-8"))
    names = set(listed.group(1).split())
    pages = [run_blocks.ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "libslam/README.md")]
    pages += sorted((run_blocks.ROOT / "docs").rglob("*.md"))
    missing = []
    for page in pages:
        name = page.relative_to(run_blocks.ROOT).with_suffix("").as_posix()
        marks = [mark for _, mark, _ in run_blocks.blocks(page.read_text(encoding="utf-8"))]
        if name not in names and any(not mark.startswith("not run") for mark in marks):
            missing.append(f"{name}.md: has commands that no test runs, expected {name} in tests/CMakeLists.txt")
    print("\n".join(missing) or f"{len(pages)} pages, {len(names)} of them with commands")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
