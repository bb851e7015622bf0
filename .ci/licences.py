#!/usr/bin/env python3
"""Refuses dependencies whose licence is not allowed in deny.toml, where `cargo deny` is not installed. Standard library only.

usage: licences.py      in the repository; exit 1 and one line per crate that is refused
"""
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


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
            found.add((name, version, licence or None))
    return sorted(found, key=str)


def main():
    with open(ROOT / "deny.toml", "rb") as file:
        rules = tomllib.load(file)["licenses"]
    allow = set(rules["allow"])
    exceptions = {e["crate"]: set(e["allow"]) for e in rules.get("exceptions", [])}
    found = packages()
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
