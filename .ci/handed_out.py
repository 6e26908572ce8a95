"""What a folder of distributions should hold: the source, a wheel for every CPython, a wheel without compiled files."""

from __future__ import annotations

import sys
import tarfile
import zipfile
from pathlib import Path
from runpy import run_path

PROJECT = Path(__file__).parents[1]
MODULES = run_path(str(PROJECT / "heuncli/kernel/modules.py"))["MODULES"]
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
    (compiled,) = folder.glob("*-cp311-abi3-*.whl")
    (plain,) = folder.glob("*-py3-none-any.whl")
    with tarfile.open(source) as archive:
        names = {member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()}
    generated = {name for name in names if name.startswith("heuncli.egg-info/")} | {"PKG-INFO", "setup.cfg"}
    top = ("README.md", "pyproject.toml", ".ci/*")
    wrong = differ(source.name, names - generated, files("heuncli/**/*", "specs/**/*", "tests/**/*", *top))

    package = files("heuncli/**/*")
    for wheel in (compiled, plain):
        names = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
        kernel = {name for name in names if name.endswith(COMPILED)}
        wrong += differ(wheel.name, names - kernel, package)
        stems = sorted(Path(name).name.partition(".")[0] for name in kernel)
        if stems != (sorted(MODULES) if wheel is compiled else []):
            wrong.append(f"{wheel.name} holds compiled modules {sorted(kernel)}")
        wrong += [f"{name} is for one version of Python" for name in kernel if ".cp" in name.lower()]
    return wrong


if __name__ == "__main__":
    sys.exit("\n".join(main(Path(sys.argv[1]))) or 0)
