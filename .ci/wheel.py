#!/usr/bin/env python3
"""Packs the extension module that the workspace's build has made into a wheel, laid out as maturin lays it out.

`maturin build` would compile most of the workspace once more: features of dependencies are unified over what is built, and it
builds one package. Needs the PyPI package `wheel`.

usage: wheel.py LIBRARY FOLDER      for example target/release/lib_residyn.so target/wheels
"""
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main(library, folder):
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    project = tomllib.loads((ROOT / "python/pyproject.toml").read_text())["project"]
    tag = subprocess.run(
        [sys.executable, "-c", "import sysconfig; print(sysconfig.get_platform().replace('-', '_').replace('.', '_'))"],
        check=True, capture_output=True, text=True,
    ).stdout.strip()
    with tempfile.TemporaryDirectory() as work:
        tree = Path(work) / f"residyn-{version}"
        shutil.copytree(ROOT / "python/residyn", tree / "residyn", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(library, tree / "residyn/_residyn.abi3.so")
        info = tree / f"residyn-{version}.dist-info"
        info.mkdir()
        lines = ["Metadata-Version: 2.1", "Name: residyn", f"Version: {version}", f"Summary: {project['description']}",
                 f"Requires-Python: {project['requires-python']}", *(f"Requires-Dist: {d}" for d in project["dependencies"])]
        (info / "METADATA").write_text("\n".join(lines) + "\n")
        wheel = ["Wheel-Version: 1.0", "Generator: .ci/wheel.py", "Root-Is-Purelib: false", f"Tag: cp39-abi3-{tag}"]
        (info / "WHEEL").write_text("\n".join(wheel) + "\n")
        Path(folder).mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", str(tree), "--dest-dir", str(folder)], check=True)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
