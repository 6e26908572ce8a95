"""Random robots as URDF texts: trees of any shape, joints of every type, frames turned anyhow, names of any script."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

import numpy as np

MOVING = ("revolute", "continuous", "prismatic")
EVERY_KIND = (*MOVING, "fixed")
SHAPES = ("chain", "star", "bush", "tree")
# Words as files have them: with spaces and slashes, words of the format, two that differ by marks alone, other scripts.
WORDS = (
    "link", "arm-1", "arm 1", "arm_1", "arm.1", "left/hip", "left hip", "1st", "t", "pi", "ground", "gravity", "drives",
    "motion", "sin", "on", "null", "ünterarm", "unterarm", "плечо", "肘", "ذراع", "κ", "e\u0301paule", "épaule",
    "finger#2", "a: b", "[x]", "{y}", "a&b", "<c>", "it's", '"q"', "__", "-", "π/2", "🦾",
)  # fmt: skip
Frame = tuple[np.ndarray, np.ndarray]  # xyz, rpy


@dataclass(frozen=True, eq=False)
class DrawnLink:
    """A link: its mass, None without an inertial; the frame of that; its inertia there, (3, 3)."""

    name: str
    mass: float | None
    frame: Frame
    inertia: np.ndarray


@dataclass(frozen=True, eq=False)
class DrawnJoint:
    """A joint as the file has it; mimic: the joint that it follows, by which factor and offset."""

    name: str
    kind: str
    parent: str
    child: str
    frame: Frame
    axis: np.ndarray
    mimic: tuple[str, float, float] | None = None


@dataclass(frozen=True, eq=False)
class DrawnRobot:
    """A robot and its text. The first link is the root."""

    links: Sequence[DrawnLink]
    joints: Sequence[DrawnJoint]
    text: str

    @property
    def moving(self) -> list[DrawnJoint]:
        """Those that have a coordinate of their own."""
        return [joint for joint in self.joints if joint.kind in MOVING and joint.mimic is None]


@dataclass(frozen=True)
class Wishes:
    """What a drawn robot is to be: shape of its tree, kinds of its joints by weight, shares of what is odd.

    bare: share of links without an inertial, each on a fixed joint; bare_root: that of the root, which may stand on no
    joint at all; mimics: share of joints that follow another one; first: the type of the first joint, else drawn;
    scales: masses lie between these, by their logarithm [kg].
    """

    links: int = 8
    shape: str = "tree"
    kinds: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(EVERY_KIND, 1.0))
    bare: float = 0.15
    bare_root: float = 0.5
    mimics: float = 0.15
    odd_names: bool = True
    first: str = ""
    scales: tuple[float, float] = (0.05, 20.0)
    shuffled: bool = True


def drawn_robot(seed: int, wishes: Wishes) -> DrawnRobot:
    """The robot of a seed: physical, so that nothing of it needs a repair."""
    rng = np.random.default_rng(seed)
    names = _names(rng, 2 * wishes.links, odd=wishes.odd_names)
    links = [_link(rng, names[0], wishes, bare=bool(rng.random() < wishes.bare_root))]
    joints: list[DrawnJoint] = []
    for k in range(1, wishes.links):
        first = wishes.first if k == 1 else ""
        bare = bool(rng.random() < wishes.bare) and not first
        joint = _joint(rng, names[wishes.links + k], wishes, "fixed" if bare else first)
        parent = links[_parent(rng, wishes.shape, k)].name
        leaders = [j.name for j in joints if j.mimic is None and j.kind in MOVING]
        mimic = None
        if leaders and joint.kind in MOVING and rng.random() < wishes.mimics:
            factor, offset = rng.uniform(-2, 2), rng.choice([0.0, rng.uniform(-0.3, 0.3)])
            mimic = (str(rng.choice(leaders)), float(factor), float(offset))
        links.append(_link(rng, names[k], wishes, bare=bare))
        joints.append(DrawnJoint(joint.name, joint.kind, parent, names[k], joint.frame, joint.axis, mimic))
    return DrawnRobot(links, joints, _text(rng, links, joints, shuffled=wishes.shuffled))


def _names(rng: np.random.Generator, count: int, *, odd: bool) -> list[str]:
    """Different names, of WORDS while they last."""
    plain = [f"part_{k}" for k in range(count)]
    if not odd:
        return plain
    words = [str(word) for word in rng.permutation(WORDS)][:count]
    return [str(name) for name in rng.permutation([*words, *plain[len(words) :]])]


def _parent(rng: np.random.Generator, shape: str, k: int) -> int:
    """The number of link k's parent."""
    if shape == "chain":
        return k - 1
    if shape == "star":
        return 0
    return int(rng.integers(max(0, k - 3) if shape == "bush" else 0, k))


def _link(rng: np.random.Generator, name: str, wishes: Wishes, *, bare: bool) -> DrawnLink:
    """A link whose inertia is that of a cloud of points, from a needle to a ball."""
    low, high = np.log(wishes.scales)
    mass = float(np.exp(rng.uniform(low, high)))
    second = rng.uniform(0.02, 1, 3) ** 2 * 0.1  # of the cloud along its axes [m²]
    turn = _rotation(rng.uniform(-3, 3, 3))
    spread = turn @ np.diag(second) @ turn.T
    inertia = mass * (np.trace(spread) * np.eye(3) - spread)
    return DrawnLink(name, None if bare else mass, _frame(rng), inertia)


def _joint(rng: np.random.Generator, name: str, wishes: Wishes, kind: str) -> DrawnJoint:
    """A joint of a kind, else of a drawn one; half of the axes are those of the frame, of what is planar z."""
    weights = np.array(list(wishes.kinds.values()))
    kind = kind or str(rng.choice(list(wishes.kinds), p=weights / weights.sum()))
    axis = rng.choice([-1.0, 1.0]) * np.eye(3)[rng.integers(3)]
    if kind == "planar":  # Pinocchio knows no other
        axis = np.array([0.0, 0.0, 1.0])
    elif rng.integers(2):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
    return DrawnJoint(name, kind, "", "", _frame(rng), axis)


def _frame(rng: np.random.Generator) -> Frame:
    """A frame as files have them: nothing, right angles, or anyhow."""
    xyz, rpy = rng.uniform(-0.5, 0.5, 3), rng.uniform(-np.pi, np.pi, 3)
    kind = rng.integers(4)
    if kind == 0:
        return np.zeros(3), np.zeros(3)
    return (xyz, np.round(rpy / (np.pi / 2)) * 1.57079632679) if kind == 1 else (xyz, rpy)


def _rotation(rpy: np.ndarray) -> np.ndarray:
    """Turned about the fixed x, then y, then z."""
    (ca, cb, cc), (sa, sb, sc) = np.cos(rpy), np.sin(rpy)
    x = np.array([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])
    y = np.array([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
    z = np.array([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])
    return np.asarray(z @ y @ x)


def _numbers(values: np.ndarray) -> str:
    return quoteattr(" ".join(repr(float(value)) for value in values))


def _origin(frame: Frame) -> str:
    """An origin; what is zero may be left out, as files do."""
    xyz, rpy = frame
    if not xyz.any() and not rpy.any():
        return ""
    return f"    <origin xyz={_numbers(xyz)} rpy={_numbers(rpy)}/>\n"


def _link_text(link: DrawnLink) -> str:
    if link.mass is None:
        return f"  <link name={quoteattr(link.name)}/>\n"
    rows = ("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)
    inertia = " ".join(f'{key}="{float(link.inertia[i, k])!r}"' for key, i, k in rows)
    return (
        f"  <link name={quoteattr(link.name)}>\n    <inertial>\n{_origin(link.frame)}"
        f'    <mass value="{link.mass!r}"/>\n    <inertia {inertia}/>\n    </inertial>\n  </link>\n'
    )


def _joint_text(joint: DrawnJoint) -> str:
    lines = [f"  <joint name={quoteattr(joint.name)} type={quoteattr(joint.kind)}>\n", _origin(joint.frame)]
    lines.append(f"    <parent link={quoteattr(joint.parent)}/>\n    <child link={quoteattr(joint.child)}/>\n")
    if joint.kind in (*MOVING, "planar") and not np.array_equal(joint.axis, [1, 0, 0]):
        lines.append(f"    <axis xyz={_numbers(joint.axis)}/>\n")
    if joint.kind in ("revolute", "prismatic"):
        lines.append('    <limit lower="-3" upper="3" effort="100" velocity="10"/>\n')
    if joint.mimic is not None:
        leader, factor, offset = joint.mimic
        lines.append(f'    <mimic joint={quoteattr(leader)} multiplier="{factor!r}" offset="{offset!r}"/>\n')
    return "".join([*lines, "  </joint>\n"])


def _text(rng: np.random.Generator, links: Sequence[DrawnLink], joints: Sequence[DrawnJoint], *, shuffled: bool) -> str:
    """The file: links and joints in any order."""
    pieces = [*map(_link_text, links), *map(_joint_text, joints)]
    order = rng.permutation(len(pieces)) if shuffled else range(len(pieces))
    body = "".join(pieces[k] for k in order)
    return f'<?xml version="1.0" encoding="utf-8"?>\n<robot name="drawn">\n{body}</robot>\n'
