#!/usr/bin/env python3
"""Prints the modules of the workspace with what they import, and fails where some import each other in a circle.

A module is a file; a room is a folder (with its `mod.rs`) or a file beside `lib.rs`. An import is a path of the same crate
that is named in the text (`use` or written out), tests aside; a parent that declares a child does not import it by that, a
child that uses `super::x` imports the file where `x` is defined. Between crates cargo allows no circle.

usage: modules.py [--rooms] [--check]
"""
import os
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def without_tests(text):
    """Text without comments and test modules at its end."""
    text = re.sub(r"//[^\n]*", "", text)
    return re.split(r"#\[cfg\(test\)\]\s*mod \w+ *\{", text)[0]


def crate_modules(source):
    """Module path (tuple) of each file of a crate's source folder."""
    modules = {}
    for file in sorted(source.rglob("*.rs")):
        parts = list(file.relative_to(source).with_suffix("").parts)
        if parts[-1] in ("mod", "lib", "main"):
            top = parts[-1] == "main"
            parts = parts[:-1] + (["main"] if top else [])
        if "tests" in parts:
            continue
        modules[tuple(parts)] = file
    return modules


def flat(tree):
    """Paths of a use tree: `a::{b, c::d}` gives a::b and a::c::d."""
    tree = tree.strip()
    brace = tree.find("{")
    if brace < 0:
        return [tree.split(" as ")[0].strip()]
    head, body = tree[:brace], tree[brace + 1 : tree.rfind("}")]
    depth, part, parts = 0, "", []
    for c in body:
        depth += (c == "{") - (c == "}")
        if c == "," and depth == 0:
            parts.append(part)
            part = ""
        else:
            part += c
    parts.append(part)
    return [head + p for one in parts if one.strip() for p in flat(one)]


def imports(module, text, modules, reexports, crate):
    """Modules of the same crate that the text names."""
    found = set()
    paths = []
    for use in re.findall(r"\buse\s+([^;]+);", text):
        paths += flat(re.sub(r"\s+", " ", use))
    paths += re.findall(r"\b((?:crate|super|self)(?:::\w+)+)", re.sub(r"\buse\s+[^;]+;", "", text))
    declared = set(re.findall(r"\bmod\s+(\w+)\s*;", text))
    paths += re.findall(r"(?<![\w:])(\w+(?:::\w+)+)", re.sub(r"\buse\s+[^;]+;", "", text)) if declared else []
    for path in paths:
        parts = path.replace(" ", "").split("::")
        if parts[0] == "crate" or (parts[0] == crate and module == ("main",)):
            full = tuple(parts[1:])
        elif parts[0] == "super":
            base = module
            while parts and parts[0] == "super":
                base, parts = base[:-1], parts[1:]
            full = base + tuple(parts)
        elif parts[0] == "self" or parts[0] in declared:
            full = module + tuple(parts[parts[0] == "self" :])
        else:
            continue
        full = resolve(full, modules, reexports)
        if full is not None and full != module:
            found.add(full)
    return found


def resolve(full, modules, reexports):
    """The module in which the item of a path is defined, following re-exports."""
    for _ in range(8):
        for cut in range(len(full), -1, -1):
            if full[:cut] in modules:
                break
        owner, rest = full[:cut], full[cut:]
        if not rest:
            return owner
        target = reexports.get(owner, {}).get(rest[0])
        if target is None:
            return owner
        full = target + rest[1:]
    return owner


def read(source, crate):
    modules = crate_modules(source)
    texts = {m: without_tests(f.read_text()) for m, f in modules.items()}
    reexports = {}
    for module, text in texts.items():
        declared = set(re.findall(r"\bmod\s+(\w+)\s*;", text))
        for use in re.findall(r"\bpub(?:\([^)]*\))?\s+use\s+([^;]+);", text):
            for path in flat(re.sub(r"\s+", " ", use)):
                parts = path.replace(" ", "").split("::")
                name = parts[-1]
                if parts[0] == "crate":
                    full = tuple(parts[1:])
                elif parts[0] == "super":
                    full = module[:-1] + tuple(parts[1:])
                elif parts[0] == "self":
                    full = module + tuple(parts[1:])
                elif parts[0] in declared:
                    full = module + tuple(parts)
                else:
                    continue
                reexports.setdefault(module, {})[name] = full
    graph = {}
    for module, text in texts.items():
        # What a file only hands on is not used by it.
        own = re.sub(r"\bpub(?:\([^)]*\))?\s+use\s+[^;]+;", "", text)
        graph[module] = imports(module, own, modules, reexports, crate)
    return graph


def circles(graph):
    """Strongly connected components of more than one module (Tarjan)."""
    index, low, stack, on, out = {}, {}, [], set(), []

    def visit(v):
        index[v] = low[v] = len(index)
        stack.append(v)
        on.add(v)
        for w in sorted(graph.get(v, ())):
            if w not in index:
                visit(w)
                low[v] = min(low[v], low[w])
            elif w in on:
                low[v] = min(low[v], index[w])
        if low[v] == index[v]:
            part = []
            while True:
                w = stack.pop()
                on.discard(w)
                part.append(w)
                if w == v:
                    break
            if len(part) > 1:
                out.append(sorted(part))

    sys.setrecursionlimit(10_000)
    for v in sorted(graph):
        if v not in index:
            visit(v)
    return out


def rooms_of(graph):
    rooms = {}
    for module, used in graph.items():
        room = module[:1]
        rooms.setdefault(room, set()).update(u[:1] for u in used if u[:1] != room)
    return rooms


def main():
    bad = 0
    check = "--check" in sys.argv
    total = arrows = 0
    for manifest in sorted([*ROOT.glob("*/Cargo.toml"), *ROOT.glob("*/*/Cargo.toml")]):
        source = manifest.parent / "src"
        if not source.is_dir():
            continue
        package = tomllib.loads(manifest.read_text())
        crate = package.get("lib", {}).get("name") or package["package"]["name"].replace("-", "_")
        graph = read(source, crate)
        rooms = rooms_of(graph)
        name = lambda m: "::".join(m) or "lib"
        if not check:
            print(f"{crate}")
            shown = rooms if "--rooms" in sys.argv else graph
            for module in sorted(shown):
                print(f"  {name(module)}: {', '.join(sorted(map(name, shown[module]))) or '-'}")
        total += len(graph)
        arrows += sum(map(len, graph.values()))
        for kind, found in (("modules", circles(graph)), ("rooms", circles(rooms))):
            for circle in found:
                bad += 1
                print(f"circle of {kind} in {crate}: {', '.join(map(name, circle))}")
    print(f"{total} modules, {arrows} imports, {bad} circles")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
