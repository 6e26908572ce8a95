"""specs/broken: what the first lines of a file promise, and the cure that its last lines give."""

from __future__ import annotations

import re
from pathlib import Path

from tests.shared.folders import ROOT

FILES = sorted((ROOT / "specs" / "broken").glob("*.yaml"))
HEAD = re.compile(r"# (code|warning): ([\w-]+)(?: at (\d+):(\d+))?\n# see: (.+)\n(?:# set: (\w+)=(.*)\n)?")
CURE = re.compile(r"^# cure: (.*)\n", re.MULTILINE)


def head(path: Path) -> re.Match[str]:
    """What the first lines of a file promise."""
    found = HEAD.match(path.read_bytes().decode("latin-1"))
    assert found is not None, f"{path.name} does not begin with '# code: x at line:column' and '# see: ...'"
    return found


def body(path: Path) -> str:
    """The spec of a file, without what it says of itself."""
    text = path.read_bytes().decode("latin-1" if path.stem == "not-utf8" else "utf-8")
    return CURE.sub("", HEAD.sub("", text, count=1))


def cures(path: Path) -> list[tuple[str, str]]:
    """What is to be written in the place of what; a cure in words is one whose second half is empty."""
    found = CURE.findall(path.read_bytes().decode("latin-1" if path.stem == "not-utf8" else "utf-8"))
    assert found, f"{path.name} does not end with '# cure: WRONG => RIGHT', or words"
    pairs = (line.replace("\\n", "\n").replace("\\u2028", "\u2028").partition(" => ") for line in found)
    return [(wrong, right) if arrow else (wrong, "") for wrong, arrow, right in pairs]


def is_in_words(path: Path) -> bool:
    """Whether the cure is told in words alone."""
    return " => " not in "".join(CURE.findall(path.read_bytes().decode("latin-1")))


def cured(path: Path) -> str:
    """The whole file with its cures applied."""
    text = path.read_bytes().decode("utf-8")
    first, _, rest = text.partition("\n")
    rest = CURE.sub("", rest)
    for wrong, right in cures(path):
        assert wrong in rest, f"{path.name}: {wrong!r} does not stand in it"
        rest = rest.replace(wrong, right, 1)
    return f"{first}\n{rest}"
