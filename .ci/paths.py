#!/usr/bin/env python3
"""Exit 1 where a document names a file or folder of this repository that is not there.

Looked at: words in backticks and link targets in tracked Markdown that have a slash and end in a slash or in a known
suffix. A path may be given from the root, from the document, or from any folder (`measure/resonance/`).
"""

import re
import subprocess
import sys
from pathlib import Path

SUFFIXES = (".rs", ".py", ".md", ".toml", ".urdf", ".sh", ".json", ".csv", ".parquet", ".html")
# What users and tools make, and what is lent for tests and not part of the repository.
OUTSIDE = ("target/", "residyn-demo/", "../", "model/", "out/", "DIR/", "cases/", "truth/", "reports/")


def tracked() -> list[str]:
    out = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True)
    return out.stdout.splitlines()


def named(text: str) -> set[str]:
    words = re.findall(r"`([^`\s]+)`", text) + re.findall(r"\]\(([^)#\s]+)", text)
    return {w for w in words if "/" in w and (w.endswith("/") or w.endswith(SUFFIXES))}


def exists(path: str, document: Path, files: list[str]) -> bool:
    if (document.parent / path).exists() or Path(path).exists():
        return True
    if path.endswith("/"):
        return any(f"/{path}" in f"/{f}" for f in files)
    return any(f"/{f}".endswith(f"/{path}") for f in files)


def main() -> int:
    files = tracked()
    lost = []
    for document in (Path(f) for f in files if f.endswith(".md")):
        for path in sorted(named(document.read_text())):
            plain = not re.search(r"[<>*{}$:…]|/x\.rs$|[A-Z]{2,}/", path)
            if plain and not path.startswith(OUTSIDE) and not exists(path, document, files):
                lost.append(f"{document}: `{path}` is not there")
    print("\n".join(lost) if lost else "every path that a document names is there")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
