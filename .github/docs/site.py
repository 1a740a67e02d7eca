#!/usr/bin/env python3
"""Gathers the documentation's pages and pictures for MkDocs: .github/docs/site.py FOLDER

Pages stand in docs/ and are read on GitHub too, where links reach the whole repository. In the offline site the pictures come
along, and a link to a file of the repository that is no page becomes its path as text.
"""
import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def rewritten(text, page):
    def link(found):
        mark, words, target = found.groups()
        name, _, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target) or not name:
            return found.group(0)
        file = (page.parent / name).resolve()
        docs = ROOT / "docs"
        if mark and docs not in file.parents:
            up = "../" * len(page.relative_to(docs).parents[0].parts)
            return f"![{words}]({up}pictures/{file.name})"
        if mark or (file.suffix == ".md" and docs in file.parents):
            return found.group(0)
        return f"{words} (`{file.relative_to(ROOT)}`)"

    return re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", link, text)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "pictures").mkdir(parents=True)
    docs = ROOT / "docs"
    for page in sorted(docs.rglob("*.md")):
        place = folder / page.relative_to(docs)
        place.parent.mkdir(exist_ok=True)
        place.write_text(rewritten(page.read_text(encoding="utf-8"), page), encoding="utf-8")
    shutil.copytree(docs / "learn" / "pictures", folder / "learn" / "pictures")
    for picture in [*(ROOT / ".github" / "pictures").glob("*.png"), *(ROOT / ".github" / "pictures").glob("*.svg")]:
        shutil.copy(picture, folder / "pictures")


if __name__ == "__main__":
    main()
