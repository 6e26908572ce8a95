"""Turn MuJoCo's tree into joints of a spec, in order; each carries one body of the spec on another.

MuJoCo stacks several joints on one body, such as a hip of three hinges. A spec has a body between any two joints, so a
carrier is put there: a point mass of CARRIER times the mass that it carries. That is below the rounding of any sum it
enters, so results are those without it, and the joints in between can have drives, springs and stops. A body with a
free joint (`freejoint`) has no joint in the spec, and one without joints has a weld.
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.frames import BodyFrames
from heuncli.scene.importers.names import assign_names

CARRIER_MASS_RATIO = 1e-20
GROUND = "ground"
JOINT_TYPES = {"mjJNT_BALL": "ball", "mjJNT_SLIDE": "slide", "mjJNT_HINGE": "pin"}
FREE = "free"
COORDINATE_KEYS = {"pin": "angle", "slide": "travel"}
RATE_KEYS = {"pin": "rate", "slide": "speed"}


class TreeJoint(NamedTuple):
    """A joint of the tree, from one body of the spec to the next.

    joint: its number in MuJoCo; None for a weld
    kind: its type in a spec, or FREE
    body: the body of MuJoCo in whose axes its place and axis are given
    """

    joint: int | None
    kind: str
    body: int
    name: str
    parent: str
    child: str


class JointTree(NamedTuple):
    """names: the spec's names of those bodies of MuJoCo that are bodies of the spec (0: the ground)
    originals: their names in MuJoCo
    carriers: the bodies between stacked joints, each with the MuJoCo body that it carries
    """

    names: dict[int, str]
    originals: dict[int, str]
    carriers: dict[str, int]  # the bodies between stacked joints, and the body that they carry
    steps: tuple[TreeJoint, ...]

    @property
    def step_by_joint(self) -> dict[int, TreeJoint]:
        """Return the steps by joint number."""
        return {step.joint: step for step in self.steps if step.joint is not None}


def build_tree(c: CompiledModel, frames: BodyFrames) -> JointTree:
    """Build the joint tree of a model."""
    owners = sorted(set(frames.owners) - {0})
    originals = {body: c.name("body", body) or f"body_{body}" for body in owners}
    joints = {body: _find_joints(c, body) for body in owners}
    joint_originals = {
        joint: _find_joint_name(c, originals[body], joint, body_joints)
        for body, body_joints in joints.items()
        for joint, _ in body_joints
    }
    welded = [body for body in owners if not joints[body]]
    names = assign_names("joint", [*joint_originals.values(), *(f"{originals[body]}_weld" for body in welded)])
    joint_names = dict(zip(joint_originals, names, strict=False))
    weld_names = dict(zip(welded, names[len(joint_originals) :], strict=True))
    carriers = [(joint, body) for body in owners for joint, _ in joints[body][:-1]]
    body_names = assign_names(
        "body", [*originals.values(), *(f"{joint_names[joint]}_carrier" for joint, _ in carriers)]
    )
    name_by_body = {0: GROUND, **dict(zip(owners, body_names, strict=False))}
    carrier_names = dict(zip((joint for joint, _ in carriers), body_names[len(owners) :], strict=True))

    def steps() -> Iterator[TreeJoint]:
        for body in owners:
            at = name_by_body[frames.owners[int(c.model.body_parentid[body])]]
            for joint, kind in joints[body]:
                child = carrier_names.get(joint, name_by_body[body])
                yield TreeJoint(joint, kind, body, joint_names[joint], at, child)
                at = child
            if body in weld_names:
                yield TreeJoint(None, "weld", body, weld_names[body], at, name_by_body[body])

    return JointTree(name_by_body, originals, {carrier_names[joint]: body for joint, body in carriers}, tuple(steps()))


def _find_joints(c: CompiledModel, body: int) -> list[tuple[int, str]]:
    """List the joints of a body and their types, the one nearest to its parent first."""
    kinds = {int(getattr(c.mujoco.mjtJoint, word)): kind for word, kind in JOINT_TYPES.items()}
    first = int(c.model.body_jntadr[body])
    return [
        (k, kinds.get(int(c.model.jnt_type[k]), FREE)) for k in range(first, first + int(c.model.body_jntnum[body]))
    ]


def _find_joint_name(c: CompiledModel, body: str, joint: int, body_joints: list[tuple[int, str]]) -> str:
    """Return a joint's name; without one, that of its body, with a number if there are several."""
    position = [number for number, _ in body_joints].index(joint) + 1
    return c.name("joint", joint) or (f"{body}_{position}" if len(body_joints) > 1 else body)
