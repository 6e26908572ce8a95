"""Remove excitation from a scene: forces are left out, drives are held at their start."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.joint_kinds import RATES
from heuncli.base.records import replace
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Drive, Spec


def exclude_entries(spec: Spec, entries: Sequence[str]) -> Spec:
    """Return the spec without some forces, and with some drives held at their start."""
    drives = dict(spec.drives)
    joints = dict(spec.joints)
    t = float(spec.analysis.times[0]) if spec.analysis.type == "state" else 0.0
    for name, drive in spec.drives.items():
        if f"drives.{name}" in entries:
            drives[name] = hold_drive(drive, t)
            if drive.quantity != "length":  # a rod has no start rate that must be removed
                joints[drive.joint] = replace(joints[drive.joint], **{RATES[drive.quantity]: None})
    forces = {name: force for name, force in spec.forces.items() if f"forces.{name}" not in entries}
    return spec._replace(forces=forces, drives=drives, joints=joints)


def hold_drive(drive: Drive, t: float) -> Drive:
    """Return a drive that keeps its coordinate at the start value."""
    value = 0.0 if drive.by_rate else drive.value.value(t)
    return replace(drive, value=Expression.from_number(value, drive.value.location))
