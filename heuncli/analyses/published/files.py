"""The files of the published cases: for each a spec and the numbers that others published of it. Impure: reads them."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent


def names() -> tuple[str, ...]:
    """The names of all cases, sorted."""
    return tuple(sorted(path.stem for path in (FOLDER / "numbers").glob("*.yaml")))


def spec_of(name: str) -> str:
    """The spec of a case, as text."""
    return (FOLDER / "specs" / f"{name}.yaml").read_text(encoding="utf-8")


def numbers_of(name: str) -> str:
    """The file of the numbers of a case, as text."""
    return (FOLDER / "numbers" / f"{name}.yaml").read_text(encoding="utf-8")
