"""Errors of the assembly: they name the joint, the gap and the two bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.results.results import Array


def does_not_fit(mechanism: Mechanism, distance: Array, angle: Array, size: float, joints: Sequence[int]) -> SolveError:
    """Make the error for poses that do not fit: distance [m] and angle [rad] by which joints stay open; names the worst
    of `joints`.
    """
    open_by = np.maximum(distance, size * angle)
    k = max(joints, key=open_by.__getitem__)
    joint = mechanism.joints[k]
    is_distance = bool(distance[k] >= size * angle[k])
    between = f"{_name(mechanism, joint.a)} and {_name(mechanism, joint.b)}"
    if is_distance:
        gap = f"its points on {between} remain {distance[k]:.3g} m from where the joint requires them"
    else:
        gap = f"{between} remain misaligned by {math.degrees(angle[k]):.3g} deg"
    if all(_is_held(mechanism, i, is_distance) for i in (joint.a, joint.b)):
        what = "position" if is_distance else "orientation"
        return SolveError(
            Problem(
                "held-conflict",
                f"joint {joint.name} ({joint.kind}): {gap}; both are prescribed",
                hint=f"leave out the {what} of one of them" + _other_hints(mechanism, k, joints),
                entry_path=f"joints.{joint.name}",
            )
        )
    return SolveError(Problem(
        "does-not-fit", f"joint {joint.name} ({joint.kind}) cannot be assembled: {gap}",
        hint="check the points and lengths; prescribe fewer start values; or set closer start positions by near:"
        + _other_hints(mechanism, k, joints), entry_path=f"joints.{joint.name}",
    ))  # fmt: skip


def rates_do_not_fit(mechanism: Mechanism, speed: Array, spin: Array, size: float, joints: Sequence[int]) -> SolveError:
    """Make the error for rates that do not fit: the residual of each joint [m/s], [rad/s]; names the worst of
    `joints`.
    """
    k = max(joints, key=np.maximum(speed, size * spin).__getitem__)
    joint = mechanism.joints[k]
    gap = f"{speed[k]:.3g} m/s" if speed[k] >= size * spin[k] else f"{spin[k]:.3g} rad/s"
    message = (
        f"joint {joint.name} ({joint.kind}): the start velocities of {_name(mechanism, joint.a)} and "
        f"{_name(mechanism, joint.b)} are incompatible at the joint by {gap}"
    )
    return SolveError(Problem(
        "rates-do-not-fit", message,
        hint="prescribe fewer velocities; heun computes the others from the joints" + _drive_hint(mechanism, joints),
        entry_path=f"joints.{joint.name}",
    ))  # fmt: skip


def no_length(mechanism: Mechanism, joint: int) -> SolveError:
    """Make the error for a rod whose points coincide."""
    name = mechanism.joints[joint].name
    message = f"joint {name} (rod): its two points coincide at the start, so it has no direction"
    hint = "give its length, or move one of the points"
    return SolveError(Problem("no-length", message, hint=hint, entry_path=f"joints.{name}"))


def too_many(mechanism: Mechanism, island: AssemblyIsland, what: str) -> SolveError:
    """Make the error for an island with more bodies than are fitted at once."""
    name = mechanism.joints[(island.closures or island.tree_joints)[0]].name
    message = (
        f"the loop at joint {name} connects {len(island.members):,} "
        f"bodies whose start {what} do not fit: too many to fit at once"
    )
    return SolveError(Problem("too-many-together", message, hint=f"give the {what} of more of its bodies",
                              entry_path=f"joints.{name}"))  # fmt: skip


def singular_pose(mechanism: Mechanism, joint: int, joints: Sequence[int]) -> SolveError:
    """Make the error for rates without accelerations; joint: a closure of the loop concerned, joints: all of the
    loop.
    """
    message = (
        f"the loop at joint {mechanism.joints[joint].name} is in a singular position (e.g. links in line), "
        "where no acceleration exists for its start velocities"
    )
    hint = (
        "give the rate of one more joint of the loop; all rates together must belong to a motion through this position"
    )
    hint += _drive_hint(mechanism, joints)
    return SolveError(Problem("singular-pose", message, hint=hint, entry_path=f"joints.{mechanism.joints[joint].name}"))


def _name(mechanism: Mechanism, body: int) -> str:
    return "ground" if body == GROUND else mechanism.bodies[body].name


def _is_held(mechanism: Mechanism, body: int, is_distance: bool) -> bool:
    if body == GROUND:
        return True
    b = mechanism.bodies[body]
    return b.rotation is not None and (not is_distance or b.position is not None)


def _other_hints(mechanism: Mechanism, k: int, joints: Sequence[int]) -> str:
    """Suggest what else may be changed: the drives of these joints, or what joint k holds at the start."""
    joint = mechanism.joints[k]
    initial_values = [n for n in ("angle", "travel") if getattr(joint, n) is not None]
    return _drive_hint(mechanism, joints) or (
        f"; or change the initial {initial_values[0]} of the joint" if initial_values else ""
    )


def _drive_hint(mechanism: Mechanism, joints: Sequence[int]) -> str:
    names = [drive.name for k in joints if (drive := mechanism.joints[k].drive) is not None]
    if not names:
        return ""
    return f"; or change drive {names[0]}" if len(names) == 1 else f"; or change one of the drives {', '.join(names)}"
