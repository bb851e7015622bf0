#!/usr/bin/env python3
"""Writes docs/commands/: a page for every command of `residyn`, which is what its --help says.

usage: commands.py [--check] [FOLDER]      the folder of the program, target/release unless given; --check: exit 1 where a page is
                                           not what the program says, and nothing is written. Pages of commands that the program
                                           was built without (the feature `reproductions`) stay as they are
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = ROOT / "docs/commands"
#: Where more is said of a command than its options.
MORE = {
    "demo": ["start.md"],
    "train": ["identification.md", "torque-channel.md", "compensator.md", "formats.md"],
    "eval": ["formats.md", "control.md", "sources.md"],
    "diagnose": ["diagnosis.md", "formats.md"],
    "replay": ["replay.md", "formats.md"],
    "excite": ["excitation.md"],
    "payload": ["payload.md"],
    "feedforward": ["embedding.md", "formats.md"],
    "machine": ["machines.md"],
    "decoupled": ["decoupled.md"],
    "report": ["formats.md"],
    "simulate": ["architecture.md"],
}
#: Commands that are no programs by themselves.
ALONE = ("demo", "report")


def said(program, words):
    """What the program prints of a command by --help."""
    done = subprocess.run([program, *words, "--help"], check=True, stdout=subprocess.PIPE, text=True)
    return "\n".join(line.rstrip() for line in done.stdout.strip().splitlines())


def commands(text):
    """Names of the commands that a help lists."""
    listed = re.search(r"^Commands:\n((?:  .*\n|\n)+)", text, re.M)
    names = re.findall(r"^  (\w+)", listed[1], re.M) if listed else []
    return [name for name in names if name != "help"]


def sections(program, words):
    """A command's help, then those of the commands below it."""
    text = said(program, words)
    level = "#" * len(words)
    yield f"{level} residyn {' '.join(words)}\n\n```text\n{text}\n```\n"
    for name in commands(text):
        yield from sections(program, [*words, name])


def pages(program):
    """Path and text of every page."""
    for name in commands(said(program, [])):
        more = ", ".join(f"[{page.removesuffix('.md')}](../{page})" for page in MORE[name])
        head, *rest = sections(program, [name])
        title, _, body = head.partition("\n")
        alone = "" if name in ALONE else f", or the program `{name}` by itself"
        text = f"{title}\n\n`residyn {name}`{alone}. More: {more}.\n{body}"
        yield PAGES / f"{name}.md", "\n".join([text, *rest])


def main(arguments):
    check = "--check" in arguments
    folder = next((a for a in arguments if a != "--check"), "target/release")
    program = str((ROOT / folder / "residyn").resolve())
    wanted = dict(pages(program))
    wrong = [p for p, text in wanted.items() if not p.is_file() or p.read_text() != text]
    wrong += [p for p in PAGES.glob("*.md") if p.stem not in MORE]
    if check:
        for path in wrong:
            print(f"{path.relative_to(ROOT)} is not what the program says: python3 .ci/commands.py")
        print(f"commands: {len(wanted)} pages, {len(wrong)} to be written again")
        return len(wrong) > 0
    PAGES.mkdir(exist_ok=True)
    for path, text in wanted.items():
        path.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
