"""How to make a redundant model determinate: joints replaced by looser ones, found by trying."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, product

import numpy as np

from heuncli.account import freedoms_of_tree, redundancy
from heuncli.mechanism.joints import JOINTS
from heuncli.mechanism.model import GROUND, Joint
from heuncli.motion import Runner
from heuncli.results import Block
from heuncli.scene import Scene, arranged

MOST_TRIED = 400  # replacements tried before the hint is given up

# What a joint may be replaced by so that it holds less; the gentlest first.
LOOSER: dict[str, tuple[str, ...]] = {
    "pin": ("universal", "ball", "cylinder", "line"),
    "slide": ("cylinder", "line"),
    "cylinder": ("line",),
    "universal": ("ball",),
    "weld": ("pin", "universal", "ball"),
    "ball": ("line", "plane"),
    "line": ("plane",),
}

USUAL = frozenset({"pin", "universal", "ball", "cylinder", "line"})  # a pin with side play is a line along its axis


def advice(scene: Scene, model: Block) -> list[str]:
    """A replacement of joints that leaves nothing open and changes no freedom, or that none was found.

    Nothing for a planar scene, and where nothing is held twice.
    """
    joints = scene.mechanism.joints
    if scene.mechanism.planar or not model["redundant"]:
        return []
    for tried, (names, changed) in enumerate(_replacements(joints, model["redundant"])):
        if tried >= MOST_TRIED:
            break
        other = arranged(replace(scene.mechanism, joints=changed), scene.start)
        if other.idle != () and len(other.idle) > len(scene.idle):
            continue
        freedoms = freedoms_of_tree(other.layout) - len(other.layout.rows)
        if redundancy(other, Runner(other.layout)).generic == 0 and freedoms == model["freedoms"]:
            return [f"determinate with {' and '.join(names)}: the same motion, and no reaction is open"]
    return stepwise(scene, model)


def stepwise(scene: Scene, model: Block) -> list[str]:
    """Joints loosened one after another, inner ones first, wherever that opens less and changes no freedom."""
    joints, left, names = scene.mechanism.joints, model["redundant"], list[str]()
    for k in sorted(range(len(joints)), key=lambda k: GROUND in (joints[k].a, joints[k].b)):
        if joints[k].drive is not None or left == 0:
            continue
        for kind in ("line", "ball", "universal"):
            if kind not in LOOSER.get(joints[k].kind, ()):
                continue
            changed = tuple(loosened(j, kind) if i == k else j for i, j in enumerate(joints))
            other = arranged(replace(scene.mechanism, joints=changed), scene.start)
            found = redundancy(other, Runner(other.layout))
            freedoms = freedoms_of_tree(other.layout) - (len(other.layout.rows) - found.dependent)
            if found.generic < left and freedoms == model["freedoms"] and len(other.idle) <= len(scene.idle):
                joints, left = changed, found.generic
                names.append(f"{joints[k].name} as {kind}")
                break
    if not names:
        return ["no looser joints were found that leave less open; `stiffness` on the joints concerned makes a split"]
    if left == 0:
        return [f"determinate with {', '.join(names)}: the same motion, and no reaction is open"]
    rest = f"{left} of {model['redundant']} are left; for those give joints their `stiffness`"
    return [f"with {', '.join(names)} only {rest}"]


def _replacements(joints: tuple[Joint, ...], redundant: int) -> Iterator[tuple[list[str], tuple[Joint, ...]]]:
    """Up to three joints made looser by as many conditions as are redundant; usual machine parts and few ones first."""
    unusual = set(JOINTS) - USUAL
    inner_first = sorted(range(len(joints)), key=lambda k: GROUND in (joints[k].a, joints[k].b))
    for n, parts in product((1, 2, 3), (USUAL, unusual)):
        for chosen in combinations(inner_first, n):
            for kinds in product(*(LOOSER.get(joints[k].kind, ()) for k in chosen)):
                if parts.isdisjoint(kinds) or (parts is USUAL and not parts.issuperset(kinds)):
                    continue
                pairs = list(zip(chosen, kinds, strict=True))
                less = sum(JOINTS[joints[k].kind].rows - JOINTS[kind].rows for k, kind in pairs)
                if less != redundant or any(joints[k].drive is not None for k in chosen):
                    continue
                changed = list(joints)
                for k, kind in pairs:
                    changed[k] = loosened(joints[k], kind)
                yield [f"{joints[k].name} as {kind}" for k, kind in pairs], tuple(changed)


def loosened(joint: Joint, kind: str) -> Joint:
    """The joint as another kind at the same place; a universal gets a second axis across its first."""
    if kind != "universal":
        return replace(joint, kind=kind, drive=None)
    e = np.zeros(3)
    e[int(np.argmin(np.abs(joint.to_axis)))] = 1.0
    across = e - (e @ joint.to_axis) * joint.to_axis
    return replace(joint, kind=kind, drive=None, to_axis=across / np.sqrt(across @ across), to_axis_given=True)
