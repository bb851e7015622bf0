#!/usr/bin/env python3
"""Refuses features of burn that would start threads or ask for a GPU: networks are trained one per core.

What the feature `gpu` brings may not be in the default tree at all. Features are unified over the workspace, so another crate can turn them on from far away. Standard library only.

usage: features.py      in the repository; exit 1 and one line per package that is refused
"""
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REFUSED = {"rayon", "cuda", "rocm", "metal", "vulkan", "webgpu", "wgpu", "tch", "fusion", "remote"}
GPU = ("wgpu", "cubecl-core", "cubecl-wgpu", "burn-cubecl", "burn-wgpu")


def main():
    command = ["cargo", "tree", "--workspace", "--locked", "--prefix", "none", "--format", "{p}\t{f}"]
    tree = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    burn = {line.removesuffix(" (*)") for line in tree.splitlines() if line.startswith(("burn", "cubecl"))}
    packages = {line.split()[0] for line in tree.splitlines() if line.startswith(GPU)}
    for package in sorted(packages):
        print(f"{package}: only the feature `gpu` may bring it")
    refused = len(packages)
    for line in sorted(burn):
        package, features = line.split("\t")
        for feature in sorted(REFUSED & set(features.split(","))):
            refused += 1
            print(f"{package}: feature `{feature}` is on")
    print(f"features: {len(burn)} packages of burn, {refused} refused")
    return refused > 0 or not burn


if __name__ == "__main__":
    sys.exit(main())
