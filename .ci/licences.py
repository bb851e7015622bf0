#!/usr/bin/env python3
"""Refuses dependencies whose licence is not allowed in deny.toml, where `cargo deny` is not installed. Standard library only.

usage: licences.py      in the repository; exit 1 and one line per crate that is refused
"""
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# How the text of a licence begins, for packages that give the file and no expression.
TITLES = {"Apache License Version 2.0, January 2004": "Apache-2.0"}


def allowed(expression, allow):
    """Whether an SPDX expression can be met from the licences allowed.

    OR needs one side, AND both; `/` is an old way of writing OR.
    """
    tokens = re.findall(r"\(|\)|[^\s()/]+|/", expression)
    position = 0

    def peek():
        return tokens[position] if position < len(tokens) else None

    def take():
        nonlocal position
        position += 1
        return tokens[position - 1]

    def one():
        if peek() == "(":
            take()
            result = either()
            if peek() != ")":
                raise ValueError("a bracket is not closed")
            take()
            return result
        if peek() in (None, ")", "OR", "AND", "WITH", "/"):
            raise ValueError("a licence is missing")
        name = take()
        if peek() == "WITH":
            take()
            if peek() is None:
                raise ValueError("an exception is missing")
            name = f"{name} WITH {take()}"
        return name in allow

    def both():
        result = one()
        while peek() == "AND":
            take()
            result &= one()
        return result

    def either():
        result = both()
        while peek() in ("OR", "/"):
            take()
            result |= both()
        return result

    result = either()
    if position != len(tokens):
        raise ValueError(f"unexpected {tokens[position]}")
    return result


def packages():
    """Name with version and licence of every package that some target of this workspace is built from.

    Not all of the lock file: that also names what optional features would bring which nobody turns on.
    """
    command = ["cargo", "tree", "--workspace", "--locked", "--target", "all", "--prefix", "none", "--format", "{p}\t{l}"]
    tree = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    found = set()
    for line in tree.splitlines():
        if line.strip():
            package, licence = line.removesuffix(" (*)").split("\t")
            name, version = package.split(" ")[:2]
            found.add((name, version.removeprefix("v"), licence or None))
    texts = None
    for name, version, licence in sorted(found, key=str):
        if licence is None:
            texts = licence_files() if texts is None else texts
            licence = named_in(texts.get((name, version)))
        yield name, version, licence


def licence_files():
    """Licence file of every package that has one instead of an expression, by name and version."""
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    text = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    return {
        (p["name"], p["version"]): Path(p["manifest_path"]).parent / p["license_file"]
        for p in json.loads(text)["packages"]
        if p["license_file"]
    }


def named_in(path):
    """The licence that a file is the text of; none where it is another than those of `TITLES`."""
    if path is None or not path.is_file():
        return None
    words = " ".join(path.read_text(encoding="utf-8", errors="replace").split())
    return next((licence for title, licence in TITLES.items() if words.startswith(title)), None)


def main():
    with open(ROOT / "deny.toml", "rb") as file:
        rules = tomllib.load(file)["licenses"]
    allow = set(rules["allow"])
    exceptions = {e["crate"]: set(e["allow"]) for e in rules.get("exceptions", [])}
    found = list(packages())
    refused = 0
    for name, version, licence in found:
        try:
            fine = licence is not None and allowed(licence, allow | exceptions.get(name, set()))
            reason = "not in the list of deny.toml"
        except ValueError as error:
            fine, reason = False, f"not a licence expression ({error})"
        if not fine:
            refused += 1
            print(f"{name} {version}: {licence or 'no licence stated'}: {reason}")
    print(f"licences: {len(found)} crates, {refused} refused")
    return refused > 0


if __name__ == "__main__":
    sys.exit(main())
