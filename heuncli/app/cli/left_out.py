"""`--without`: which forces and drives are left out of a scene, by their names."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem
from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format.models import Spec


def named(spec: Spec, words: Sequence[str]) -> tuple[str, ...]:
    """The entries that words name, as `forces.push`. Raises UsageError with all that do not."""
    asked = [name.strip() for word in words for name in word.split(",")]
    found = [entries_named(spec, name) for name in asked]
    wrong = [problem(spec, name, own) for name, own in zip(asked, found, strict=True) if len(own) != 1]
    if wrong:
        raise UsageError(*wrong)
    return tuple(dict.fromkeys(own[0] for own in found))


def known(spec: Spec) -> list[str]:
    """All forces and drives, as `forces.push`."""
    return [*(f"forces.{name}" for name in spec.forces), *(f"drives.{name}" for name in spec.drives)]


def entries_named(spec: Spec, name: str) -> list[str]:
    """The entries that have a name, with the block before it or without."""
    return [entry for entry in known(spec) if name in (entry, entry.partition(".")[2])]


def problem(spec: Spec, name: str, found: Sequence[str]) -> Problem:
    """What is wrong with a name that no entry has, or two."""
    if found:
        message = f"--without {name}: {' and '.join(found)} have this name"
        return Problem("bad-option", message, hint=f"say {' or '.join(found)}; or both: --without {','.join(found)}")
    if not known(spec):
        return Problem("bad-option", f"--without {name}: the scene has no forces and no drives", hint="leave it out")
    plain = [entry.partition(".")[2] for entry in known(spec)]
    hint = did_you_mean(name, known(spec) if "." in name else plain, "forces and drives")
    return Problem("bad-option", f"--without {name}: no force or drive has this name", hint=hint or "")
