#!/usr/bin/env python3
"""Refuses features of burn that would start threads or ask for a GPU: networks are trained one per core.

What the package `gpu` brings may not be in the workspace's tree at all. Features are unified over the workspace, so another crate can turn them on from far away.
The README's first command and the control loop's crate compile no more crates than they may, and neither burn nor boosted trees.
Dependencies of tests alone turn on no feature of a crate that programs have: building and testing would compile it twice.
Standard library only.

usage: features.py      in the repository; exit 1 and one line per package that is refused
"""
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REFUSED = {"rayon", "cuda", "rocm", "metal", "vulkan", "webgpu", "wgpu", "tch", "fusion", "remote"}
GPU = ("wgpu", "cubecl-core", "cubecl-wgpu", "burn-cubecl", "burn-wgpu")
#: What is built, by which packages and features, and the most crates.
LIMITS = [
    ("the README's first command", ["-p", "residyn", "--no-default-features", "--features", "diagnosis"], 230),
    ("the control loop's crate", ["-p", "residyn-feedforward"], 60),
]
#: What no crate of these may be called.
WITHOUT = ("burn", "cubecl", "forust", "candle")


def compiled(selection):
    """Crates that a build of `selection` compiles on this machine, its own among them."""
    command = ["cargo", "tree", *selection, "--locked", "--edges", "normal,build", "--prefix", "none", "--no-dedupe", "--format", "{p}"]
    tree = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    return {tuple(line.split()[:2]) for line in tree.splitlines()}


def with_features(edges):
    """Crates of the workspace's tree, each with its features."""
    command = ["cargo", "tree", "--workspace", "--locked", "--edges", edges, "--prefix", "none", "--format", "{p} {f}"]
    tree = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    return {line.removesuffix(" (*)").strip() for line in tree.splitlines()}


def main():
    command = ["cargo", "tree", "--workspace", "--locked", "--prefix", "none", "--format", "{p}\t{f}"]
    tree = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    burn = {line.removesuffix(" (*)") for line in tree.splitlines() if line.startswith(("burn", "cubecl"))}
    packages = {line.split()[0] for line in tree.splitlines() if line.startswith(GPU)}
    for package in sorted(packages):
        print(f"{package}: only the package `gpu` may bring it")
    refused = len(packages)
    for line in sorted(burn):
        package, features = line.split("\t")
        for feature in sorted(REFUSED & set(features.split(","))):
            refused += 1
            print(f"{package}: feature `{feature}` is on")
    for line in sorted(with_features("normal,build") - with_features("normal,build,dev")):
        refused += 1
        print(f"{line}: tests need it with other features; make what asks for them a dependency of `residyn-tests`")
    counted = []
    for what, selection, most in LIMITS:
        crates = compiled(selection)
        counted.append(f"{len(crates)} crates of {what}")
        for name, version in sorted(crates):
            if name.startswith(WITHOUT):
                refused += 1
                print(f"{name} {version}: not for {what}")
        if len(crates) > most:
            refused += 1
            print(f"{what} compiles {len(crates)} crates, at most {most} are allowed")
    print(f"features: {len(burn)} packages of burn, {', '.join(counted)}, {refused} refused")
    return refused > 0 or not burn


if __name__ == "__main__":
    sys.exit(main())
