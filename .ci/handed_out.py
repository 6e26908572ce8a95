"""What is handed out: the source and a wheel without compiled files, in a folder, and the wheel that is installed here.

That one was compiled, for every CPython.
"""

from __future__ import annotations

import re
import sys
import tarfile
import zipfile
from importlib.metadata import distribution
from pathlib import Path

PROJECT = Path(__file__).parents[1]
KERNEL = "heuncli/kernel/compiled.abi3.so"
COMPILED = (".so", ".pyd")


def files(*patterns: str) -> set[str]:
    """The files of this project below the patterns, compiled ones apart."""
    found = {path for pattern in patterns for path in PROJECT.glob(pattern) if path.is_file()}
    return {
        path.relative_to(PROJECT).as_posix()
        for path in found
        if path.suffix not in (*COMPILED, ".pyc") and not path.relative_to(PROJECT).parts[0].endswith("-info")
    }


def differ(what: str, found: set[str], wanted: set[str]) -> list[str]:
    """A line for each name too few or too many."""
    return [f"{what} lacks {name}" for name in sorted(wanted - found)] + [
        f"{what} should not hold {name}" for name in sorted(found - wanted)
    ]


def main(folder: Path) -> list[str]:
    (source,) = folder.glob("*.tar.gz")
    (plain,) = folder.glob("*-py3-none-any.whl")
    with tarfile.open(source) as archive:
        names = {member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()}
    generated = {name for name in names if name.startswith("heuncli.egg-info/")} | {"PKG-INFO", "setup.cfg"}
    top = ("README.md", "pyproject.toml", ".ci/*")
    wrong = differ(source.name, names - generated, files("heuncli/**/*", "specs/**/*", "tests/**/*", *top))
    names = {name for name in zipfile.ZipFile(plain).namelist() if ".dist-info/" not in name}
    wrong += differ(plain.name, names, files("heuncli/**/*"))

    installed = distribution("heuncli")
    names = {path.as_posix() for path in installed.files or () if path.parts[0] == "heuncli" and path.suffix != ".pyc"}
    wrong += differ("what is installed", names, files("heuncli/**/*") | {KERNEL})
    label = installed.read_text("WHEEL") or ""
    if not re.search("^Tag: cp311-abi3-", label, re.MULTILINE):
        wrong.append(f"the wheel that was installed is not for every CPython: {label}")
    return wrong


if __name__ == "__main__":
    sys.exit("\n".join(main(Path(sys.argv[1]))) or 0)
