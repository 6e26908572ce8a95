"""Ways to tell a scene again (retell.py, the oracle's saw), and scenes at rest with cuts through their bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from random import Random
from typing import Any

import numpy as np

from heuncli.study.queries.study import Study
from tests.oracle.masses import Mass, mass_of
from tests.oracle.read import state_at
from tests.oracle.turns import random_rotation
from tests.oracle.weld import PIECE, saw
from tests.shared import retell
from tests.shared.rest_scenes import drawn
from tests.shared.said_again import Retold

Tree = dict[str, Any]
Generator = np.random.Generator


def with_cuts(tree: Tree, rng: Generator) -> Tree:
    """The scene with a cut through each body, whose piece is told; couples at points, so that they have a side."""
    tree = {**tree, "sections": {}, "forces": dict(tree.get("forces", {}))}
    for name, load in tree["forces"].items():
        if load["type"] == "couple" and "." not in load["on"]:
            tree["forces"][name] = {**load, "on": f"{load['on']}.end"}
    for name, body in tree["bodies"].items():
        normal = rng.normal(size=3)
        end = np.array(body["points"].get("end", [0.4, 0.2, 0.1]))
        tree["sections"][f"cut_{name}"] = {
            "body": name, "at": (rng.uniform(0.2, 0.8) * end + 0.01 * rng.normal(size=3)).tolist(),
            "normal": normal.tolist(), "first_axis": rng.normal(size=3).tolist(), "piece": piece_of(body, rng),
        }  # fmt: skip
    tree["report"] = ["motion", "points", "foundation", "joints", "sections", "forces", "energy"]
    return tree if tree["forces"] else {k: v for k, v in tree.items() if k != "forces"}


def piece_of(body: Mapping[str, Any], rng: Generator) -> Tree:
    """Some part of a body: its share of the mass, a little off the centre, and of the moments less what that takes."""
    whole, share = mass_of(body), float(rng.uniform(0.2, 0.8))
    widths = np.linalg.eigvalsh(np.trace(whole.inertia) / 2.0 * np.eye(3) - whole.inertia) / whole.mass
    way = rng.normal(size=3)
    off = way / np.linalg.norm(way) * rng.uniform(0.0, 0.4) * np.sqrt(max(widths[0], 0.0))
    apart = whole.mass * share / (1.0 - share) * (float(off @ off) * np.eye(3) - np.outer(off, off))
    part = Mass(share * whole.mass, whole.center + off, share * (whole.inertia - apart))
    return {"mass": part.mass, "center": part.center.tolist(), "inertia": part.inertia.tolist()}


def in_other_axes(det: float, tree: Tree, rng: Generator, _: Study) -> Retold:
    Q = random_rotation(rng) @ np.diag([1.0, 1.0, det])
    return Retold(retell.turned(tree, Q), Q=Q)


def in_other_units(mass: float, length: float, time: float, tree: Tree, _: Generator, __: Study) -> Retold:
    return Retold(retell.in_units(tree, mass, length, time), mass=mass, length=length, time=time)


def renamed(tree: Tree, rng: Generator, _: Study) -> Retold:
    other, names = retell.renamed(tree, Random(int(rng.integers(2**32))))
    return Retold(other, names=names)


def in_halves(tree: Tree, rng: Generator, _: Study) -> Retold:
    """A body that is not cut as two, one in the other."""
    whole = {k: v for k, v in tree.items() if k != "sections"}
    return Retold(retell.in_halves(whole, Random(int(rng.integers(2**32)))), skipped=frozenset({"sections"}))


# of what is left of the sawn body another one
OF_CENTRES = {"center", "center_velocity", "center_acceleration", "center_velocity_jump"}


def sawn(tree: Tree, rng: Generator, first: Study) -> Retold:
    """A body that is cut as two, welded in the plane of the cut: the weld carries the section's load."""
    cut = list(tree["sections"].values())[int(rng.integers(len(tree["sections"])))]
    piece = mass_of(cut["piece"])
    other = saw(tree, state_at(first.results.bodies, 0), cut["body"], cut["at"], cut["normal"], piece=piece)
    other = {k: v for k, v in other.items() if v and k != "sections"}
    return Retold(other, skipped=frozenset({"sections", "mass_effect", *OF_CENTRES}))


TELLINGS: dict[str, Callable[[Tree, Generator, Study], Retold]] = {
    "turned": partial(in_other_axes, 1.0),
    "mirrored": partial(in_other_axes, -1.0),
    "inches, pounds": partial(in_other_units, 2.2, 39.37, 10.0),
    "mm, t, ms": partial(in_other_units, 1e-3, 1e3, 1e3),
    "faster": partial(in_other_units, 1.0, 1.0, 1.0 / 3.0),
    "renamed": renamed,
    "in halves": in_halves,
    "sawn": sawn,
}


def section_of_the_weld(told: Retold) -> str:
    """The section that the weld of a sawn scene stands for."""
    body = next(name for name in told.tree["bodies"] if name.endswith(PIECE)).removesuffix(PIECE)
    return f"cut_{body}"


def resting(kind: str, seed: int) -> Tree:
    """A scene of a kind (tests/shared/rest_scenes.py) with cuts."""
    return with_cuts(drawn(kind, seed).spec, np.random.default_rng([seed, 77]))
