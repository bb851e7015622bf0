#!/usr/bin/env python3
"""Installs libresidyn for C and C++ programs: library, headers, residyn.pc and the CMake package. Linux.

usage: install.py --prefix P [--build FOLDER]      FOLDER: where cargo built it, release in CARGO_TARGET_DIR or target unless given;
                                                   before: cargo build --release -p residyn-capi
"""
import argparse
import os
import shutil
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
#: What a static library of Rust's standard library needs beside it.
STATIC = ["pthread", "dl", "m", "gcc_s"]


def version():
    """Version of the workspace."""
    with open(HERE.parent / "Cargo.toml", "rb") as file:
        return tomllib.load(file)["workspace"]["package"]["version"]


def filled(template, values):
    """A template's text with `@NAME@` replaced."""
    text = (HERE / "cmake" / template).read_text()
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return text


def link(place, target):
    """A symbolic link in the place of whatever stood there."""
    place.unlink(missing_ok=True)
    place.symlink_to(target)


def main(arguments):
    parser = argparse.ArgumentParser(description="Installs libresidyn for C and C++ programs.")
    parser.add_argument("--prefix", type=Path, required=True, metavar="P", help="folder that gets lib/ and include/")
    built_here = Path(os.environ.get("CARGO_TARGET_DIR") or HERE.parent / "target") / "release"
    parser.add_argument("--build", type=Path, default=built_here, metavar="FOLDER", help="where cargo built it")
    given = parser.parse_args(arguments)
    built = {name: given.build / f"libresidyn_c.{name}" for name in ("so", "a")}
    for path in built.values():
        if not path.is_file():
            print(f"error: {path} is not there: cargo build --release -p residyn-capi", file=sys.stderr)
            return 2
    number = version()
    full, major = f"libresidyn.so.{number}", f"libresidyn.so.{number.split('.')[0]}"
    prefix = given.prefix.resolve()
    lib, include = prefix / "lib", prefix / "include"
    for folder in (lib / "pkgconfig", lib / "cmake/residyn", include):
        folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(built["so"], lib / full)
    shutil.copyfile(built["a"], lib / "libresidyn.a")
    link(lib / major, full)
    link(lib / "libresidyn.so", major)
    for header in ("residyn.h", "residyn.hpp"):
        shutil.copyfile(HERE / "include" / header, include / header)
    values = {"VERSION": number, "LIBRARY": full, "SONAME": major, "STATIC_PC": " ".join(f"-l{s}" for s in STATIC),
              "STATIC": ";".join(STATIC)}
    (lib / "pkgconfig/residyn.pc").write_text(filled("residyn.pc.in", values))
    for name in ("residynConfig.cmake", "residynConfigVersion.cmake"):
        (lib / "cmake/residyn" / name).write_text(filled(f"{name}.in", values))
    print(f"libresidyn {number} stands in {prefix}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
