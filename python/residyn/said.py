"""What the programs say, in the words of Python: recordings by their argument, options as keywords."""

from __future__ import annotations

import re
from typing import Mapping

#: Options that are True or False.
_SWITCHES = frozenset("basic ceiling fast learn moving_only physics_only resume yardsticks".split())
#: Options with a value that functions of the package take by the same name.
_VALUES = frozenset(
    "average before cutoff_hz data drive epochs estimator harmonics heldout joints lmi members out preset prior rate ridge rloess robot seed"
    " threads weight".split()
)
#: What a function does otherwise, or a program alone.
_OTHERWISE = (
    (r"eval --predict\b", "`Model.predict`"),
    (r"`residyn (diagnose|replay|train)`", r"`residyn.\1`"),
    (r"--next FILE\.csv", "`next_motion=True`"),
    (r"--patch OUT", "`report.patch`"),
    (r"`?\btrain --check-only\b`?", "`residyn.check`"),
)
#: Options with a word as value, and the words.
_WORDS = re.compile(r"(?<![\w`-])--(estimator|lmi|preset|weight) (default|every|hard|huber|irls|iterative|last|off|ols|tukey|ucm|wls)\b")
#: An option of a command line, with the placeholder of its value.
_OPTION = re.compile(r"'?(?<![\w`-])--([a-z][a-z-]*)(?: <[A-Z_]+>(?:\.\.\.)?'?| FILE\.toml)?")


def in_python(text: str, names: Mapping[str, str] = {}) -> str:
    """`text` with temporary files by their `names` and with options as keywords. Rows of such files have their index, too."""
    for path, name in names.items():
        at = re.compile(re.escape(path) + r"(?:, row (\d+)(?: \(line \d+\))?)?")
        text = at.sub(lambda m: name if m[1] is None else f"{name}, row {m[1]} (index {int(m[1]) - 1})", text)
    text = re.sub(r"\Aerror: |\s*For more information, try '--help'\.\s*\Z", "", text)
    for pattern, said in _OTHERWISE:
        text = re.sub(pattern, said, text)
    return _OPTION.sub(_keyword, _WORDS.sub(r'`\1="\2"`', text))


def _keyword(option: re.Match[str]) -> str:
    """A keyword argument; an option that no function takes stays."""
    name = option[1].replace("-", "_")
    return f"`{name}=True`" if name in _SWITCHES else f"`{name}`" if name in _VALUES else option[0]
