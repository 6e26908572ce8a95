"""Springs, dampers and the like of MuJoCo's that a spec has, too; its stops.

hinge      -k (q - springref) - d q'    a turn_spring, a damper
slide      the same along its axis      a torque (thrust) by its travel, a damper
negative   k or d, which drive          a torque by the coordinate or its rate
ball       -d sigma, relative           a damper
tendon     straight, k (length - lengthspring), d of its rate: a spring
gravcomp   -gravcomp m g at the centre of mass: a force
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from heuncli.scene.importers.described import DescribedEntry
from heuncli.scene.importers.mjcf.closings import Closer, straight
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.frames import BodyFrames, vec
from heuncli.scene.importers.mjcf.laws import zero
from heuncli.scene.importers.mjcf.points import PointsMade
from heuncli.scene.importers.mjcf.tree import COORDINATE, RATE, JointTree, TreeStep
from heuncli.scene.importers.spec_text import number_text, pointed

Name = Callable[[str], str]


def joint_loads(c: Compiled, tree: JointTree, name: Name) -> Iterator[DescribedEntry]:
    """Springs and dampers in the joints of the tree."""
    springs, dampers = not c.switched_off("PASSIVE", "SPRING"), not c.switched_off("PASSIVE", "DAMPER")
    for step in tree.steps:
        if step.joint is None:
            continue
        stiffness = float(c.model.jnt_stiffness[step.joint]) if springs else 0.0
        damping = float(c.model.dof_damping[c.model.jnt_dofadr[step.joint]]) if dampers else 0.0
        if stiffness and step.kind in COORDINATE:
            reference = float(c.model.qpos_spring[c.model.jnt_qposadr[step.joint]])
            yield _spring(step, stiffness, reference - zero(c, step.joint), name)
        if (step.kind in COORDINATE and damping) or (step.kind == "ball" and damping > 0.0):
            yield _damper(step, damping, name)


def _damper(step: TreeStep, damping: float, name: Name) -> DescribedEntry:
    wanted = name(f"damping_{step.name}")
    if damping > 0.0:
        return DescribedEntry(wanted, {"type": "damper", "joint": step.name, "coefficient": damping})
    law = f"{pointed(-damping)}*{step.name}.{RATE[step.kind]}"
    return DescribedEntry(wanted, {"type": "torque", "joint": step.name, "value": law}, "a damping below 0")


def _spring(step: TreeStep, stiffness: float, free: float, name: Name) -> DescribedEntry:
    if step.kind == "pin" and stiffness > 0.0:
        keys = {"type": "turn_spring", "joint": step.name, "stiffness": stiffness, **({"angle": free} if free else {})}
        return DescribedEntry(name(f"spring_{step.name}"), keys)
    way = f"{step.name}.{COORDINATE[step.kind]}"
    if free:
        way = f"({way} {'-' if free > 0.0 else '+'} {number_text(abs(free))})"
    keys = {"type": "torque", "joint": step.name, "value": f"{number_text(-stiffness)}*{way}"}
    remark = "a spring along the slide" if stiffness > 0.0 else "a stiffness below 0"
    return DescribedEntry(name(f"spring_{step.name}"), keys, remark)


def is_tendon_spring(c: Compiled, tendon: int) -> bool:
    """Whether a tendon is a spring, a damper, or both, between two sites; below 0 it is neither."""
    low, high = (float(length) for length in c.model.tendon_lengthspring[tendon])
    both = float(c.model.tendon_stiffness[tendon]), float(c.model.tendon_damping[tendon])
    return max(both) > 0.0 <= min(both) and straight(c, tendon) is not None and low == high


def tendon_springs(c: Compiled, closer: Closer, name: Name) -> Iterator[DescribedEntry]:
    """Springs between two sites."""
    springs, dampers = not c.switched_off("PASSIVE", "SPRING"), not c.switched_off("PASSIVE", "DAMPER")
    for tendon in range(c.count("tendon")):
        sites = straight(c, tendon)
        if sites is None or not is_tendon_spring(c, tendon):
            continue
        stiffness = float(c.model.tendon_stiffness[tendon]) if springs else 0.0
        damping = float(c.model.tendon_damping[tendon]) if dampers else 0.0
        if not (stiffness or damping):
            continue
        its = [closer.site(site) for site in sites]
        if closer.holder(its[0]) == closer.holder(its[1]):
            continue  # its length stays, and its pulls are one body's
        wanted = name(c.name("tendon", tendon) or f"tendon_{tendon + 1}")
        ends = [closer.point(end, wanted) for end in its]
        keys: dict[str, Any] = {"type": "spring", "from": ends[0], "to": ends[1], "stiffness": stiffness}
        keys["length"] = float(c.model.tendon_lengthspring[tendon][0])
        if damping:
            keys["damping"] = damping
        yield DescribedEntry(wanted, keys, c.told("tendon", tendon))


def weightless(
    c: Compiled, frames: BodyFrames, tree: JointTree, points: PointsMade, gravity: Any, name: Name, free: bool
) -> Iterator[DescribedEntry]:
    """What carries the weight of bodies that MuJoCo takes it from; not with both springs and dampers switched off.

    What joints with `actuatorgravcomp` carry is their motors', and in what drives take; free joints have no drive.
    """
    if c.switched_off("PASSIVE") or (c.switched_off("SPRING") and c.switched_off("DAMPER")):
        return
    for body in range(1, int(c.model.nbody)):
        share, mass = float(c.model.body_gravcomp[body]), float(c.model.body_mass[body])
        if not (share and mass and frames.owners[body]) or not any(gravity):
            continue
        if not free and all(by_motor(c, body)):
            continue
        its = tree.names[frames.owners[body]]
        center = points.add(its, "center", frames.place(body, c.model.body_ipos[body]))
        vector = vec(-share * mass * g for g in gravity)
        remark = f"gravcomp {number_text(share)} of {c.told('body', body)}"
        yield DescribedEntry(name(f"gravcomp_{its}"), {"type": "force", "on": center, "vector": vector}, remark)


def by_motor(c: Compiled, body: int) -> list[bool]:
    """Of each joint that carries a body, whether its motor takes the weight off (`actuatorgravcomp`)."""
    found: list[bool] = []
    while body:
        first = int(c.model.body_jntadr[body])
        found += [bool(c.model.jnt_actgravcomp[k]) for k in range(first, first + int(c.model.body_jntnum[body]))]
        body = int(c.model.body_parentid[body])
    return found


def stops(c: Compiled, tree: JointTree, driven: frozenset[int], name: Name) -> Iterator[DescribedEntry]:
    """The limits of the joints that no drive moves: where the coordinate comes to one, a blow without rebound."""
    if c.switched_off("LIMIT", "CONSTRAINT"):
        return
    for step in tree.steps:
        if step.joint is None or step.joint in driven or not c.model.jnt_limited[step.joint]:
            continue
        if step.kind in COORDINATE:
            low, high = (float(limit) - zero(c, step.joint) for limit in c.model.jnt_range[step.joint])
            yield DescribedEntry(name(f"limits_{step.name}"), {"joint": step.name, COORDINATE[step.kind]: (low, high)})
