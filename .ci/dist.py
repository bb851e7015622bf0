#!/usr/bin/env python3
"""Packs a release: `residyn` as one static program, manual pages, completions, licences and a bill of materials, tried in an empty root.

The program is linked with the C library, so that it runs on any Linux of its processor. Standard library only.

usage: dist.py FOLDER      for example target/dist; writes residyn-VERSION-TARGET.tar.gz and its .sha256 there
"""
import gzip
import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Files of a crate that hold its licence begin so.
LICENCES = ("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE")


def run(*command, **options):
    """Standard output of a command that has to succeed."""
    return subprocess.run(command, check=True, cwd=ROOT, stdout=subprocess.PIPE, text=True, **options).stdout


def build(target):
    """Builds the program and the writer of its manual; the folder that they lie in."""
    flags = f"{os.environ.get('RUSTFLAGS', '')} -C target-feature=+crt-static".strip()
    # A target of its own keeps the flag from build scripts and procedural macros.
    run("cargo", "build", "--release", "--locked", "--target", target, "--package", "residyn", "--package", "residyn-manual", "--bins",
        env={**os.environ, "RUSTFLAGS": flags, "CARGO_PROFILE_RELEASE_STRIP": "symbols"})
    folder = json.loads(run("cargo", "metadata", "--format-version", "1", "--no-deps"))["target_directory"]
    return Path(folder) / target / "release"


def crates(target):
    """Every package that the program is built from, with the features that it is built with, by name."""
    lines = run("cargo", "tree", "--locked", "--package", "residyn", "--target", target, "--edges", "normal,build",
                "--prefix", "none", "--format", "{p}").splitlines()
    used = {tuple(line.split()[:2]) for line in lines if line}
    metadata = json.loads(run("cargo", "metadata", "--format-version", "1", "--locked"))
    found = (p for p in metadata["packages"] if (p["name"], f"v{p['version']}") in used)
    return sorted(found, key=lambda p: (p["name"], p["version"]))


def bill(packages, version):
    """A bill of materials as CycloneDX has it."""
    parts = [
        {"type": "library", "name": p["name"], "version": p["version"], "purl": f"pkg:cargo/{p['name']}@{p['version']}",
         "licenses": [{"expression": " ".join(p["license"].replace("/", " OR ").split())}] if p["license"] else []}
        for p in packages if p["source"]
    ]
    return json.dumps({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": {"component": {"type": "application", "name": "residyn", "version": version}}, "components": parts,
    }, indent=1)


def notices(packages):
    """Licence of each third-party crate, with the texts that it ships."""
    out = []
    for p in packages:
        if p["source"]:
            out.append(f"==== {p['name']} {p['version']}: {p['license'] or 'see its text'}")
            texts = sorted(f for f in Path(p["manifest_path"]).parent.iterdir() if f.is_file() and f.name.upper().startswith(LICENCES))
            out.extend(f.read_text(errors="replace") for f in texts)
    return "\n".join(out)


def pack(tree, archive, time):
    """A tar archive that is the same, byte for byte, for the same files and time."""
    def plain(entry):
        entry.uid = entry.gid = 0
        entry.uname = entry.gname = ""
        entry.mtime = time
        entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
        return entry

    content = io.BytesIO()
    with tarfile.open(fileobj=content, mode="w") as tar:
        for path in [tree, *sorted(tree.rglob("*"))]:
            tar.add(path, str(path.relative_to(tree.parent)), recursive=False, filter=plain)
    archive.write_bytes(gzip.compress(content.getvalue(), mtime=time))


def try_out(archive, name):
    """Unpacks the archive into an empty root and runs the demo there, with devices and a temporary folder as a container has them."""
    with tempfile.TemporaryDirectory() as root, tarfile.open(archive) as tar:
        tar.extractall(root, filter="data")
        enter = 'mkdir -p "$0/dev" "$0/tmp" && mount --rbind /dev "$0/dev" && exec chroot "$0" "$@"'
        inside = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", enter, root, f"/{name}/bin/residyn"]
        print(run(*inside, "--version").strip())
        print(run(*inside, "demo").splitlines()[0])
        if not (Path(root) / "residyn-demo/gap.html").is_file():
            sys.exit("the demo wrote no report in an empty root")


def main(folder):
    target = next(line.split()[1] for line in run("rustc", "-vV").splitlines() if line.startswith("host:"))
    built = build(target)
    packages = crates(target)
    version = next(p["version"] for p in packages if p["name"] == "residyn")
    name = f"residyn-{version}-{target}"
    time = int(run("git", "log", "-1", "--format=%ct"))
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    archive = folder / f"{name}.tar.gz"
    with tempfile.TemporaryDirectory() as work:
        tree = Path(work) / name
        (tree / "bin").mkdir(parents=True)
        shutil.copy(built / "residyn", tree / "bin")
        run(str(built / "manual"), "--prefix", str(tree))
        for file in ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"]:
            shutil.copy(ROOT / file, tree)
        (tree / "THIRD-PARTY.txt").write_text(notices(packages))
        (tree / "bill-of-materials.cdx.json").write_text(bill(packages, version))
        pack(tree, archive, time)
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    (folder / f"{archive.name}.sha256").write_text(f"{digest}  {archive.name}\n")
    try_out(archive, name)
    print(f"{archive}: {archive.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
