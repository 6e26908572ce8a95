"""The joints of MuJoCo's tree, one after the other: each carries one body of the spec on another.

MuJoCo stacks several joints on one body: a hip of three hinges. A spec has a body between any two joints. So a carrier
stands there: a point mass of CARRIER times the mass of what it carries. That is less than a rounding of any sum in
which it stands: the numbers are those of no mass at all, and the joints between have theirs (drives, springs, stops).
A body with joints of all six freedoms (`freejoint`) has no joint in the spec, and one without joints a weld.
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.frames import BodyFrames
from heuncli.scene.importers.names import names_of

CARRIER = 1e-20
GROUND = "ground"
KINDS = {"mjJNT_BALL": "ball", "mjJNT_SLIDE": "slide", "mjJNT_HINGE": "pin"}
FREE = "free"
COORDINATE = {"pin": "angle", "slide": "travel"}
RATE = {"pin": "rate", "slide": "speed"}


class TreeStep(NamedTuple):
    """One joint of the tree, from one body of the spec to the next.

    joint: its number in MuJoCo, None of a weld; kind: its type in a spec, or FREE; body: the body of MuJoCo in whose
    axes its place and its axis are given.
    """

    joint: int | None
    kind: str
    body: int
    name: str
    parent: str
    child: str


class JointTree(NamedTuple):
    """names: of those bodies of MuJoCo that are bodies of the spec (0: the ground); wanted: what MuJoCo calls them."""

    names: dict[int, str]
    wanted: dict[int, str]
    carriers: dict[str, int]  # the bodies between stacked joints, and the body that they carry
    steps: tuple[TreeStep, ...]

    @property
    def of_joint(self) -> dict[int, TreeStep]:
        """The steps by the number of the joint."""
        return {step.joint: step for step in self.steps if step.joint is not None}


def tree_of(c: Compiled, frames: BodyFrames) -> JointTree:
    """The tree of a model."""
    owners = sorted(set(frames.owners) - {0})
    wanted = {body: c.name("body", body) or f"body_{body}" for body in owners}
    joints = {body: _joints(c, body) for body in owners}
    called = {joint: _joint_name(c, wanted[body], joint, its) for body, its in joints.items() for joint, _ in its}
    welded = [body for body in owners if not joints[body]]
    names = names_of("joint", [*called.values(), *(f"{wanted[body]}_weld" for body in welded)])
    of_joint = dict(zip(called, names, strict=False))
    of_weld = dict(zip(welded, names[len(called) :], strict=True))
    carriers = [(joint, body) for body in owners for joint, _ in joints[body][:-1]]
    body_names = names_of("body", [*wanted.values(), *(f"{of_joint[joint]}_carrier" for joint, _ in carriers)])
    of_body = {0: GROUND, **dict(zip(owners, body_names, strict=False))}
    of_carrier = dict(zip((joint for joint, _ in carriers), body_names[len(owners) :], strict=True))

    def steps() -> Iterator[TreeStep]:
        for body in owners:
            at = of_body[frames.owners[int(c.model.body_parentid[body])]]
            for joint, kind in joints[body]:
                child = of_carrier.get(joint, of_body[body])
                yield TreeStep(joint, kind, body, of_joint[joint], at, child)
                at = child
            if body in of_weld:
                yield TreeStep(None, "weld", body, of_weld[body], at, of_body[body])

    return JointTree(of_body, wanted, {of_carrier[joint]: body for joint, body in carriers}, tuple(steps()))


def _joints(c: Compiled, body: int) -> list[tuple[int, str]]:
    """The joints of a body and their kinds, the one nearest to its parent first."""
    kinds = {int(getattr(c.mujoco.mjtJoint, word)): kind for word, kind in KINDS.items()}
    first = int(c.model.body_jntadr[body])
    return [
        (k, kinds.get(int(c.model.jnt_type[k]), FREE)) for k in range(first, first + int(c.model.body_jntnum[body]))
    ]


def _joint_name(c: Compiled, body: str, joint: int, its: list[tuple[int, str]]) -> str:
    """A joint without a name has that of its body, with a number where there are several."""
    place = [number for number, _ in its].index(joint) + 1
    return c.name("joint", joint) or (f"{body}_{place}" if len(its) > 1 else body)
