"""Random models of MuJoCo's: trees of bodies on hinges, slides, balls and free joints, several on a body; as MJCF.

Frames, places of joints, masses and axes of inertia stand askew; some bodies have no joint, some of these no mass, and
some that move have none but by what is fixed to them. Nothing of heun is used.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tests.oracle.turns import Array

WAYS = {"hinge": 1, "slide": 1, "ball": 3, "free": 6}  # rates of a joint


@dataclass
class RandomTree:
    """A model: its bodies in MJCF, and what its joints are, in MuJoCo's order."""

    text: str = ""
    joints: list[tuple[str, str]] = field(default_factory=list)  # name, type

    def model(self, option: str = "", rest: str = "") -> str:
        """The whole file; option: attributes and elements of <option>; rest: what follows the bodies."""
        return (
            '<mujoco model="random"><compiler angle="radian" balanceinertia="false"/>'
            f'<option gravity="1 -2 -9.5" {option}><flag contact="disable"/></option>'
            f'<worldbody><site name="wall" pos="0.1 0.2 0.3"/>{self.text}</worldbody>{rest}</mujoco>'
        )


def words(values: Array) -> str:
    """Numbers in all their digits."""
    return " ".join(repr(float(value)) for value in np.atleast_1d(values))


def random_tree(rng: np.random.Generator, count: int, kinds: tuple[str, ...], loads: bool) -> RandomTree:
    """A tree of so many bodies that move; kinds: of their joints; loads: springs, dampers, and weights taken off."""
    tree = RandomTree()
    below: dict[int, list[int]] = {}
    for body in range(count):
        free = "free" in kinds and rng.random() < 0.3
        parent = -1 if body == 0 or free else int(rng.integers(-1, body))
        below.setdefault(parent, []).append(body)
        if free:
            below.setdefault(-2, []).append(body)
    frees = set(below.get(-2, ()))
    texts = {}
    for body in reversed(range(count)):
        inner = "".join(texts[child] for child in below.get(body, ()))
        texts[body] = _body(rng, tree, body, inner, ("free",) if body in frees else kinds, loads)
    tree.text = "".join(texts[child] for child in below.get(-1, ()))
    return tree


def _body(
    rng: np.random.Generator, tree: RandomTree, body: int, inner: str, kinds: tuple[str, ...], loads: bool
) -> str:
    names = "".join(_joint(rng, tree, body, number, kinds, loads) for number in range(_how_many(rng, kinds)))
    hidden = rng.random() < 0.2  # its mass is that of a body fixed to it
    gravcomp = f'gravcomp="{words(rng.uniform(0, 1))}"' if loads and rng.random() < 0.3 else ""
    mass = _inertial(rng)
    fixed = f'<body name="fixed {body}" {_pose(rng)}>{_inertial(rng)}<site name="tip{body}" {_pose(rng)}/></body>'
    frame = f'<body name="frame{body}" {_pose(rng)}>{fixed if rng.random() < 0.5 else ""}</body>'
    if hidden:
        mass, frame = "", f'<body name="mass {body}" {_pose(rng)}>{mass}{frame}</body>'
    return f'<body name="b{body}" {_pose(rng)} {gravcomp}>{names}{mass}{frame}{inner}</body>'


def _how_many(rng: np.random.Generator, kinds: tuple[str, ...]) -> int:
    return 1 if "free" in kinds and len(kinds) == 1 else int(rng.choice([1, 1, 2, 3]))


def _joint(
    rng: np.random.Generator, tree: RandomTree, body: int, number: int, kinds: tuple[str, ...], loads: bool
) -> str:
    kind = str(rng.choice([kind for kind in kinds if kind != "free" or len(kinds) == 1]))
    if number and kind == "ball":
        kind = "slide"  # a ball and a hinge at one place would leave a turn to nothing
    if any(name.startswith(f"j{body}_") and its == "ball" for name, its in tree.joints) and kind == "hinge":
        kind = "slide"
    name = f"j{body}_{number}"
    tree.joints.append((name, kind))
    if kind == "free":
        return f'<freejoint name="{name}"/>'
    axis = f'axis="{words(rng.normal(size=3))}"' if kind != "ball" else ""
    more = f'ref="{words(rng.normal())}"' if kind != "ball" and rng.random() < 0.5 else ""
    if loads:
        more += f' damping="{words(rng.uniform(0, 2))}"'
        if kind != "ball":
            more += f' stiffness="{words(rng.uniform(0, 50))}" springref="{words(rng.normal())}"'
    return f'<joint name="{name}" type="{kind}" pos="{words(rng.normal(size=3) * 0.2)}" {axis} {more}/>'


def _pose(rng: np.random.Generator) -> str:
    q = np.array([1.0, 0.0, 0.0, 0.0]) if rng.random() < 0.2 else rng.normal(size=4)
    return f'pos="{words(rng.normal(size=3) * 0.5)}" quat="{words(q)}"'


def _inertial(rng: np.random.Generator) -> str:
    squares = rng.uniform(0.01, 0.05, 3)  # of a body's extents: moments are sums of two of them, and so a body's
    moments = squares.sum() - squares
    return f'<inertial {_pose(rng)} mass="{words(rng.uniform(0.5, 3))}" diaginertia="{words(moments)}"/>'
