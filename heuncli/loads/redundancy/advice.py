"""How to make a redundant model determinate: joints replaced by looser ones, found by trying.

A looser joint holds part of what the one before held, so where the freedoms stay the same the motion does. Joints that
are driven, loaded, limited by a stop, named in an expression or hold a start value keep their kind: they need it. They
may give way to the moments that others hold (zero_stiffness.py).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, product

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_Z, JOINTS, POINT
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import body_states
from heuncli.loads.redundancy.count import redundancy
from heuncli.loads.redundancy.neighbours import neighbours
from heuncli.loads.redundancy.self_stress import self_stress
from heuncli.motion.integration.run.runner import Runner, ready
from heuncli.multibody.mechanism.model import GROUND, Joint, JointLoad
from heuncli.multibody.tree.prepare import PreparedScene, arranged
from heuncli.results.results import Array, Block

MOST_TRIED = 400  # replacements tried before the hint is given up

YIELDING = (np.full(3, np.inf), np.zeros(3))  # a joint's stiffness by force and by moment: it takes no moments

Choices = Mapping[int, tuple[Joint, ...]]  # joint -> what may take its place


def advice(scene: PreparedScene, model: Block) -> list[str]:
    """A replacement of joints that leaves nothing open and changes no freedom, or that none was found.

    Nothing where nothing is held twice.
    """
    redundant = int(model["redundant"]) - int(model.get("given_way", 0))
    if not redundant:
        return []
    choices = choices_of(scene)
    for tried, changed in enumerate(_replacements(scene.mechanism.joints, choices, redundant)):
        if tried >= MOST_TRIED:
            break
        if _left(scene, changed, model) == 0:
            return [f"determinate with {in_words(scene, changed, ' and ')}: the same motion, and no reaction is open"]
    return stepwise(scene, choices, model, redundant)


def stepwise(scene: PreparedScene, choices: Choices, model: Block, redundant: int) -> list[str]:
    """Joints loosened one after another, inner ones first, wherever that opens less and changes no freedom."""
    changed, left = dict[int, Joint](), redundant
    for k, kinds in choices.items():
        for other in reversed(kinds):
            found = _left(scene, {**changed, k: other}, model) if left else None
            if found is not None and found < left:
                changed[k], left = other, found
                break
    if not changed:
        return ["no looser joints were found that leave less open; `stiffness` on the joints concerned makes a split"]
    if left == 0:
        return [f"determinate with {in_words(scene, changed, ', ')}: the same motion, and no reaction is open"]
    rest = f"{left} of {redundant} are left; for those give joints their `stiffness`"
    return [f"with {in_words(scene, changed, ', ')} only {rest}"]


def choices_of(scene: PreparedScene) -> Choices:
    """Of each joint that may change what may take its place; inner joints first."""
    mechanism = scene.mechanism
    joints = mechanism.joints
    used = {joints[load.joint].name for load in mechanism.loads if isinstance(load, JointLoad)}
    used |= {joints[stop.joint].name for stop in mechanism.stops}
    used |= {joints[k].name for coupling in mechanism.couplings for k in coupling.joints}
    used |= {name for value in mechanism.expressions() for name, _ in value.uses}
    along = open_directions(scene)
    found: dict[int, tuple[Joint, ...]] = {}
    for k in sorted(range(len(joints)), key=lambda k: GROUND in (joints[k].a, joints[k].b)):
        j = joints[k]
        given = any(value is not None for value in (j.angle, j.rate, j.travel, j.speed))
        if j.drive is None and not given and j.name not in used:
            looser = JOINTS[j.kind].looser_in_plane if mechanism.planar else JOINTS[j.kind].looser
            others = (loosened(j, kind, along[k]) for kind in looser)
            found[k] = tuple(other for other in others if other is not None)
        elif JOINTS[j.kind].dots and not mechanism.planar and j.stiffness is None:
            found[k] = (replace(j, stiffness=YIELDING),)
    return found


def open_directions(scene: PreparedScene) -> list[Array | None]:
    """Of each joint the one direction in `from` axes in which its force is open; None where there are more, or none."""
    runner = Runner(scene.layout)
    here = runner.recovered(np.zeros(1), scene.layout.y0[None, :])
    poses = neighbours(runner, 0.0, here.states[0], (tolerances.NEIGHBOUR,)) or here
    states = body_states(scene.layout, poses)
    stress = self_stress(runner, poses, states)
    assert stress is not None
    found: list[Array | None] = []
    for joint, share in zip(scene.mechanism.joints, stress.shares, strict=True):
        F = share[:, :3] / np.where(stress.largest > 0.0, stress.largest, 1.0)[:, None]
        F = F if joint.a == GROUND else states.R[:, joint.a].transpose(0, 2, 1) @ F
        U, sigma, _ = np.linalg.svd(F.transpose(1, 0, 2).reshape(3, -1), full_matrices=False)
        n = U[:, 0] * np.sign(U[np.argmax(np.abs(U[:, 0])), 0])
        across, least = float(sigma[1:].max(initial=0.0)), tolerances.ONE_DIRECTION
        found.append(n if sigma[0] > least and across <= least * sigma[0] else None)
    return found


def _left(scene: PreparedScene, changed: Mapping[int, Joint], model: Block) -> int | None:
    """What is left redundant with these joints; None where they free something, or leave a spin to nobody."""
    joints = tuple(changed.get(k, j) for k, j in enumerate(scene.mechanism.joints))
    other, runner = ready(arranged(replace(scene.mechanism, joints=joints), scene.start))
    found = redundancy(other, runner)
    freedoms = other.layout.tree_freedoms - (found.closed - found.dependent) - scene.undetermined
    return found.open if freedoms == model["freedoms"] and len(other.idle) <= len(scene.idle) else None


def _replacements(joints: tuple[Joint, ...], choices: Choices, redundant: int) -> Iterator[dict[int, Joint]]:
    """Up to three joints made looser by as many conditions as are redundant, few ones first.

    One that gives way is looser by as many of its moments as others hold, one at least.
    """

    def less(k: int, other: Joint) -> tuple[int, int]:
        kind = JOINTS[joints[k].kind]
        fewer = kind.rows - JOINTS[other.kind].rows
        return (fewer, fewer) if fewer else (1, len(kind.dots))

    most = max((less(k, other)[1] for k, others in choices.items() for other in others), default=0)
    for n in (1, 2, 3):
        if n * most < redundant:
            continue
        for chosen in combinations(choices, n):
            for others in product(*(choices[k] for k in chosen)):
                least, largest = (sum(ends) for ends in zip(*map(less, chosen, others), strict=True))
                if least <= redundant <= largest:
                    yield dict(zip(chosen, others, strict=True))


def loosened(joint: Joint, kind: str, along: Array | None) -> Joint | None:
    """The joint as another kind at the same place, None where its axis is not known.

    What held the point and has no axis to slide along (a ball, or in the plane a pin) may give way along the one
    direction in which it is open; what needs a second axis gets one across its first.
    """
    before, after = JOINTS[joint.kind], JOINTS[kind]
    if before.hold is POINT and after.shifts == ("axis",) and (not before.has_axis or after.turn is ABOUT_Z):
        return replace(joint, kind=kind, axis=along, to_axis=along) if along is not None else None
    if after.to_axis != "required":
        return replace(joint, kind=kind)
    e = np.zeros(3)
    e[int(np.argmin(np.abs(joint.to_axis)))] = 1.0
    across = e - (e @ joint.to_axis) * joint.to_axis
    return replace(joint, kind=kind, to_axis=across / np.sqrt(across @ across), to_axis_given=True)


def in_words(scene: PreparedScene, changed: Mapping[int, Joint], between: str) -> str:
    """The replacements in words that can be typed: an axis where it is not the joint's own."""
    words = []
    for k, other in changed.items():
        before = scene.mechanism.joints[k]
        kind = JOINTS[other.kind]
        text = f"{other.name} as {kind.spoken or kind.name}"
        if other.kind == before.kind:
            text = f"stiffness: {{moment: 0}} on {other.name}"
        elif kind.to_axis == "required":
            text += f" (to_axis {_numbers(other.to_axis)})"
        elif kind.has_axis and other.axis is not before.axis:
            text += f" (axis {_numbers(other.axis)})"
        words.append(text)
    return between.join(words)


def _numbers(direction: Array) -> str:
    """A direction to all its digits, for a rounded one would leave a joint out of true."""
    exact = np.where(np.abs(direction) < tolerances.ZERO_COMPONENT, 0.0, direction)
    return "[" + ", ".join(f"{x:.15g}" for x in exact / np.abs(exact).max()) + "]"
