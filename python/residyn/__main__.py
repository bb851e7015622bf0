"""What the package has, and where the programs are: `python -m residyn`."""

import sys
from typing import Optional, Sequence

from . import __version__

SAID = f"""residyn {__version__}, the Python package

In Python          import residyn: residyn.diagnose, replay, identify, train; help(residyn.diagnose)
As commands        python -m residyn.verify --help     the gap closed in MuJoCo itself
                   python -m residyn.fleet --help      many robots on a Ray cluster

The programs train, eval, diagnose, replay and residyn are no part of the package: `cargo build --release` in a clone of the repository
writes them to target/release; `residyn --help` lists what there is."""


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Says what there is. Status 2 where a program's command is given."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    if given in (["--version"], ["-V"]):
        print(f"residyn {__version__}")
        return 0
    wrong = given not in ([], ["--help"], ["-h"])
    if wrong:
        print(f"error: python -m residyn does not take: {' '.join(given)}", file=sys.stderr)
    print(SAID, file=sys.stderr if wrong else sys.stdout)
    return 2 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
