"""Files of the published cases: for each a spec and the numbers that others published. Impure: reads files."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent


def list_names() -> tuple[str, ...]:
    """Return the names of all cases, sorted."""
    return tuple(sorted(path.stem for path in (FOLDER / "numbers").glob("*.yaml")))


def spec_of(name: str) -> str:
    """Return the spec of a case, as text."""
    return (FOLDER / "specs" / f"{name}.yaml").read_text(encoding="utf-8")


def numbers_of(name: str) -> str:
    """Return the file of the numbers of a case, as text."""
    return (FOLDER / "numbers" / f"{name}.yaml").read_text(encoding="utf-8")
