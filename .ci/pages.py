#!/usr/bin/env python3
"""Exit 1 where a page that people read first is too long: lines, width, words of a sentence. Code and tables count as lines alone.

usage: pages.py      in the repository
"""

import re
import sys
from pathlib import Path

#: Page, most lines, most characters of a line.
PAGES = [("README.md", 120, 160), ("docs/start.md", 80, 170), ("docs/diagnosis.md", 250, 400), ("docs/replay.md", 250, 400)]
#: Pages whose sentences are counted, and the most words of one.
PLAIN = ("README.md", "docs/start.md", "docs/replay.md")
WORDS = 35


def sentences(text):
    """Sentences of the paragraphs and lists, without code, tables, headings, markup."""
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    text = re.sub(r"<[^>]*>", "", text)
    blocks = re.split(r"\n\s*\n|\n(?=- |\d+\. |[|#])", text)
    prose = [b for b in blocks if b.strip() and not b.startswith(("    ", "|", "#", "\n"))]
    for block in prose:
        plain = re.sub(r"`[^`]*`", "code", re.sub(r"\]\([^)]*\)", "]", block))
        yield from re.split(r"(?<=[.:;?!])\s+", " ".join(plain.split()))


def main():
    faults = []
    for name, most, width in PAGES:
        lines = Path(name).read_text().splitlines()
        if len(lines) > most:
            faults.append(f"{name}: {len(lines)} lines, at most {most}")
        faults += [f"{name}:{n}: {len(line)} characters, at most {width}" for n, line in enumerate(lines, 1) if len(line) > width]
    for name in PLAIN:
        long = [s for s in sentences(Path(name).read_text()) if len(s.split()) > WORDS]
        faults += [f"{name}: a sentence of {len(s.split())} words, at most {WORDS}: {s[:80]} …" for s in long]
    print("\n".join(faults) or "the pages that people read first are short enough")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
