"""`--without`: the scene without what excites it: forces are left out, drives are held where they start."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.cli.entry import UsageError
from heuncli.errors import Problem
from heuncli.expressions.programs import Expression
from heuncli.joint_kinds import RATES
from heuncli.nearest import did_you_mean
from heuncli.records import replace
from heuncli.spec.models import Drive, Spec

KINDS = ("forces", "drives")


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


def without(spec: Spec, entries: Sequence[str]) -> Spec:
    """The spec without some forces, and with some drives held where they start."""
    drives = dict(spec.drives)
    joints = dict(spec.joints)
    t = float(spec.analysis.times[0]) if spec.analysis.type == "state" else 0.0
    for name, drive in spec.drives.items():
        if f"drives.{name}" in entries:
            drives[name] = held(drive, t)
            if drive.quantity != "length":  # a rod's is held with no rate beside it
                joints[drive.joint] = replace(joints[drive.joint], **{RATES[drive.quantity]: None})
    forces = {name: force for name, force in spec.forces.items() if f"forces.{name}" not in entries}
    return spec._replace(forces=forces, drives=drives, joints=joints)


def held(drive: Drive, t: float) -> Drive:
    """A drive that keeps its coordinate as it has it at the start."""
    value = 0.0 if drive.by_rate else drive.value.value(t)
    return replace(drive, value=Expression.of(value, drive.value.location))
