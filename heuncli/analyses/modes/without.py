"""A scene without what excites it: forces are left out, drives are held where they start."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.joint_kinds import RATES
from heuncli.base.records import replace
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Drive, Spec


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
