#!/usr/bin/env python3
"""Exit 1 where pages are not as readers need them.

Looked at: lines and width of the pages that people read first; words of a sentence (code and tables have none); a page
for every effect of both catalogues, with its five headings; relative links of the documentation; options in its command lines.

usage: pages.py      in the repository
"""

import re
import sys
from pathlib import Path

#: Pages of docs/tutorials.
TUTORIALS = ("first-diagnosis", "so101-without-torque", "ur5e-ros2-bag", "feedforward-cpp")
#: Page, most lines, most characters of a line.
PAGES = [
    ("README.md", 120, 160),
    ("docs/start.md", 80, 170),
    *((f"docs/tutorials/{name}.md", 80, 200) for name in TUTORIALS),
    ("docs/diagnosis.md", 170, 200),
    ("docs/diagnosis-method.md", 120, 200),
    ("docs/diagnosis-limits.md", 60, 200),
    ("docs/diagnosis-proof.md", 335, 200),
    ("docs/replay.md", 250, 400),
    ("docs/compensator.md", 250, 250),
    ("docs/identification.md", 250, 300),
]
#: Pages of which rows of tables may be wider.
WIDE = ("docs/diagnosis.md", "docs/diagnosis-limits.md", "docs/diagnosis-proof.md")
#: Pages whose sentences are counted, and the most words of one.
PLAIN = (
    "README.md",
    "docs/start.md",
    *(f"docs/tutorials/{name}.md" for name in TUTORIALS),
    "docs/diagnosis.md",
    "docs/diagnosis-method.md",
    "docs/diagnosis-limits.md",
    "docs/diagnosis-proof.md",
    "docs/replay.md",
)
WORDS = 35
#: Pages of which sentences are not counted: a list of links, and what programs print.
UNCOUNTED = ("docs/SUMMARY.md", "docs/commands/")
#: The most words of a sentence of all other pages.
MANY = 38
#: Headings of an effect's page in their order, and its most lines and characters of a line.
HEADINGS = ["What it is", "How it looks", "Confused with", "What to do", "How well it is found"]
EFFECT = (40, 160)
#: Source of the effects that `diagnose` and `replay` name.
TORQUE, MOTION = Path("diagnose/src/catalogue"), Path("replay/src/catalogue.rs")


def sentences(text):
    """Sentences of the paragraphs and lists, without code, tables, headings, markup."""
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    text = re.sub(r"<[^>]*>", "", text)
    blocks = re.split(r"\n\s*\n|\n(?=- |\d+\. |[|#])", text)
    prose = [b for b in blocks if b.strip() and not b.startswith(("    ", "|", "#", "\n"))]
    for block in prose:
        plain = re.sub(r"`[^`]*`", "code", re.sub(r"\]\([^)]*\)", "]", block))
        yield from re.split(r"(?<=[.:;?!])\s+", " ".join(plain.split()))


def size(name, most, width):
    """Faults of a page in its lines and their width."""
    lines = Path(name).read_text().splitlines()
    wide = [(n, line) for n, line in enumerate(lines, 1) if len(line) > width and not (name in WIDE and line.startswith("|"))]
    faults = [f"{name}:{n}: {len(line)} characters, at most {width}" for n, line in wide]
    faults += [f"{name}: it is empty"] * (not any(lines))
    return faults + [f"{name}: {len(lines)} lines, at most {most}"] * (len(lines) > most)


def catalogue():
    """Names of all effects in the sources of both catalogues, and faults where they are not all found."""
    text = "".join(f.read_text() for f in sorted(TORQUE.rglob("*.rs")))
    torque = re.findall(r": Info = Info \{\s*name: \"(\w+)\"", text)
    count = re.search(r"const ALL: \[Effect; (\d+)\]", text)
    text = MOTION.read_text()
    listed = re.search(r"const ALL: \[Self; \d+\] = \[(.*?)\]", text, flags=re.S)
    names = dict(re.findall(r"Self::(\w+) => \"(\w+)\"", text))
    motion = [names.get(variant) for variant in re.findall(r"Self::(\w+)", listed[1])] if listed else [None]
    faults = [f"{TORQUE}: {len(torque)} names are read, not those of all effects"] * (not count or int(count[1]) != len(torque))
    faults += [f"{MOTION}: the names of its effects are not read"] * (None in motion)
    return {name for name in torque + motion if name}, faults


def effects():
    """Faults of the effects' pages and of their index."""
    names, faults = catalogue()
    pages = {path.stem: path for path in Path("docs/effects").glob("*.md")}
    faults += [f"docs/effects/{name}.md is missing" for name in sorted(names - pages.keys())]
    faults += [f"{pages[name]}: no catalogue has this effect" for name in sorted(pages.keys() - names)]
    index = re.findall(r"^\| \[`(\w+)`\]\(effects/(\w+)\.md\)", Path("docs/effects.md").read_text(), flags=re.M)
    faults += [f"docs/effects.md: `{name}` links to another page, {page}" for name, page in index if name != page]
    if sorted(name for name, _ in index) != sorted(pages):
        faults.append("docs/effects.md does not list each page of docs/effects once")
    for path in pages.values():
        found = re.findall(r"^## (.*)$", path.read_text(), flags=re.M)
        faults += [f"{path}: headings are {found}, not {HEADINGS}"] * (found != HEADINGS)
        faults += size(path, *EFFECT)
    return faults


def links():
    """Relative links of the documentation that lead to no file."""
    for page in sorted(path for folder in ("docs", "docs/effects", "docs/tutorials") for path in Path(folder).glob("*.md")):
        text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(), flags=re.S)
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
            if not re.match(r"\w+:", target) and not (page.parent / target).exists():
                yield f"{page}: the link to {target} leads nowhere"


def options():
    """Options that a command line of the documentation gives to a program and that its page of commands does not list."""
    pages = {path.stem: path.read_text() for path in Path("docs/commands").glob("*.md")}
    known = {name: set(re.findall(r"--[a-z][a-z-]+", text)) for name, text in pages.items()}
    called = re.compile(rf"\s*(?:residyn )?({'|'.join(known)}) (?=[^=:]*--)(.*)")
    for page in [Path("README.md"), Path("python/README.md"), *Path("docs").glob("*.md"), *Path("docs").glob("[et]*/*.md")]:
        # Provenance names commands as they were at a commit.
        text = re.split(r"^#+ Provenance$", page.read_text(), flags=re.M)[0]
        code = re.findall(r"`([^`\n]+)`", text) + re.findall(r"(?:^ {4}.*\n)+", text, re.M) + re.findall(r"```sh\n(.*?)```", text, re.S)
        for line in "\n".join(code).replace("\\\n", " ").split("\n"):
            found = called.match(line)
            given = re.findall(r"(?<![\w-])--[a-z][a-z-]+", re.split(r" && |; ", found[2])[0]) if found else []
            yield from (f"{page}: {found[1]} has no {option}: {line.strip()[:80]}" for option in given if option not in known[found[1]])


def main():
    faults = [fault for page in PAGES for fault in size(*page)]
    pages = ["README.md", "python/README.md", *map(str, sorted(Path("docs").rglob("*.md")))]
    for name in pages:
        most = WORDS if name in PLAIN else MANY
        counted = [] if name.startswith(UNCOUNTED) else sentences(Path(name).read_text())
        long = [s for s in counted if len(s.split()) > most]
        faults += [f"{name}: a sentence of {len(s.split())} words, at most {most}: {s[:80]} …" for s in long]
    faults += [*effects(), *links(), *options()]
    print("\n".join(faults) or "pages are short enough, every effect has its page, every link leads to a file")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
