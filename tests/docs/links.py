#!/usr/bin/env python3
"""Follows the links and pictures of README.md and docs/*.md to files of the repository, anchors included.

Exit code 1 and a line per dead link. Addresses on the net are not looked at.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def anchors(path):
    """As GitHub makes them of headings: lower case, blanks to hyphens, punctuation dropped."""
    found = set()
    for line in path.read_text(encoding="utf-8").split("\n"):
        heading = re.match(r"#+ (.*)", line)
        if heading:
            plain = re.sub(r"[^\w\- ]", "", heading.group(1).lower())
            found.add(plain.replace(" ", "-"))
    return found


def main():
    problems, links = [], 0
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), ROOT / "libslam" / "README.md"]
    for page in pages:
        for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
            for target in re.findall(r"\]\(([^)\s]+)\)", line):
                if re.match(r"[a-z]+:", target):
                    continue
                links += 1
                name, _, anchor = target.partition("#")
                file = (page.parent / name).resolve() if name else page
                if not file.exists():
                    problems.append(f"{page.relative_to(ROOT)}:{number}: no file {target}")
                elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                    problems.append(f"{page.relative_to(ROOT)}:{number}: no heading {target}")
    listed = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    for page in sorted((ROOT / "docs").glob("*.md")):
        if page.name != "README.md" and f"({page.name})" not in listed:
            problems.append(f"docs/README.md: does not list {page.name}")
    print(f"{links} links followed")
    sys.exit("\n".join(problems) if problems or not links else 0)


if __name__ == "__main__":
    main()
