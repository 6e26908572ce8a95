"""The equalities and fixed tendons of a model as joints of a spec: connects, welds, rods; and couplings of two joints.

In MuJoCo they are soft by their solver's nature; in a spec they hold. An end of one is a point of a body, or a site.

    connect   the two points coincide: a ball
    weld      the same, and R_W2 = R_W1 R(relquat): a weld, where that is so at the zero of all joints
    tendon    its length stays: a rod, where it runs straight from a site to a site
    joint     q1 - q1(zero) = a0 + a1 x + a2 x^2 + ..., x = q2 - q2(zero): a drive's law, where joint 2 is driven
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Matrix, Vec
from heuncli.scene.importers.attitudes import after
from heuncli.scene.importers.described import LEFT_OUT, DescribedEntry
from heuncli.scene.importers.mjcf.compiled import Compiled
from heuncli.scene.importers.mjcf.frames import BodyFrames, rotation
from heuncli.scene.importers.mjcf.points import PointsMade
from heuncli.scene.importers.mjcf.tree import GROUND, JointTree
from heuncli.scene.importers.spec_text import pointed

SAME = 1e-6  # of a turn: the digits to which people write quaternions
SITES = 2  # of a tendon that runs straight


class JointEquality(NamedTuple):
    """Joint `slave` follows joint `master` (None: it stands) by the polynomial: numbers of MuJoCo's joints."""

    equality: int
    slave: int
    master: int | None
    polynomial: tuple[float, ...]


class Closings(NamedTuple):
    """What closes loops. carried: numbers of the equalities that the spec holds; left_out: why others are not."""

    joints: tuple[DescribedEntry, ...]
    couplings: tuple[JointEquality, ...]
    carried: frozenset[int]
    rods: frozenset[int]  # the tendons that are rods
    left_out: tuple[Problem, ...]
    told: tuple[str, ...]


class ClosingEnd(NamedTuple):
    """An end of an equality: the body of MuJoCo; place [m] and attitude at the zero, in the body of the spec."""

    body: int
    place: Vec
    attitude: Matrix


def left_out(c: Compiled, kind: str, number: int, why: str, hint: str) -> Problem:
    """The problem of a part that has no counterpart in a spec."""
    location, name = c.location(kind, number), c.told(kind, number)
    where = "" if location else f"{c.file}: "
    return Problem(LEFT_OUT, f"{where}{name}: {why}", location, hint)


class Closer:
    """Makes the closings of one model; entries are added as they are found."""

    def __init__(
        self, c: Compiled, frames: BodyFrames, tree: JointTree, points: PointsMade, name: Callable[[str], str]
    ) -> None:
        self.c, self.frames, self.tree, self.points, self.name = c, frames, tree, points, name
        self.joints: list[DescribedEntry] = []
        self.couplings: list[JointEquality] = []
        self.carried: set[int] = set()
        self.rods: set[int] = set()
        self.left_out: list[Problem] = []
        self.told: list[str] = []

    def closings(self) -> Closings:
        """All of them."""
        c = self.c
        rows = {"CONNECT": self.connect, "WELD": self.weld, "JOINT": self.couple, "TENDON": self.tendon}
        of_type = {int(c.mujoco.mjtEq.__members__[f"mjEQ_{word}"]): row for word, row in rows.items()}
        names = {int(value): word[5:].lower() for word, value in c.mujoco.mjtEq.__members__.items()}
        for number in range(c.count("equality")):
            kind = int(c.model.eq_type[number])
            if not c.model.eq_active0[number] or c.switched_off("EQUALITY", "CONSTRAINT"):
                self.told.append(f"{c.told('equality', number)} is not active at the start, and left out")
            elif kind not in of_type:
                self.leave(number, f"of the type {names[kind]} there is none in a spec")
            else:
                of_type[kind](number)
        joints, couplings = tuple(self.joints), tuple(self.couplings)
        sets = frozenset(self.carried), frozenset(self.rods)
        return Closings(joints, couplings, *sets, tuple(self.left_out), tuple(self.told))

    def leave(
        self, number: int, why: str, hint: str = "what it holds is free in the spec: add what holds it there"
    ) -> None:
        """Tell that an equality is left out."""
        self.left_out.append(left_out(self.c, "equality", number, why, hint))

    def add(self, number: int, kind: str, ends: tuple[ClosingEnd, ClosingEnd], **keys: Any) -> None:
        """Add a joint between two ends."""
        wanted = self.c.name("equality", number) or f"{kind}_{number + 1}"
        self.carried.add(number)
        self.joint(wanted, self.c.told("equality", number), kind, ends, **keys)

    def joint(self, wanted: str, told: str, kind: str, ends: tuple[ClosingEnd, ClosingEnd], **keys: Any) -> None:
        bodies = [self.holder(end) for end in ends]
        if bodies[0] == bodies[1]:
            self.told.append(f"{told} holds {bodies[0]} to itself, and is left out")
            return
        name = self.name(wanted)
        ways = [self.point(end, name) for end in ends]
        if bodies[1] == GROUND:  # its load is told ON `to`: of what stands on the ground that is the moving one
            ways.reverse()
        self.joints.append(DescribedEntry(name, {"type": kind, "from": ways[0], "to": ways[1], **keys}, told))

    def ends(self, number: int, points: tuple[Any, Any]) -> tuple[ClosingEnd, ClosingEnd]:
        """The ends of an equality of two bodies with these points, or of two sites."""
        c = self.c
        ids = int(c.model.eq_obj1id[number]), int(c.model.eq_obj2id[number])
        if int(c.model.eq_objtype[number]) == int(c.mujoco.mjtObj.mjOBJ_SITE):
            return self.site(ids[0]), self.site(ids[1])
        one, other = (
            ClosingEnd(body, self.frames.place(body, point), self.frames.attitudes[body])
            for body, point in zip(ids, points, strict=True)
        )
        return one, other

    def site(self, site: int) -> ClosingEnd:
        """The end at a site."""
        model = self.c.model
        body = int(model.site_bodyid[site])
        attitude = after(self.frames.attitudes[body], rotation(model.site_quat[site]))
        return ClosingEnd(body, self.frames.place(body, model.site_pos[site]), attitude)

    def point(self, end: ClosingEnd, wanted: str) -> str:
        """A new point of a body of the spec at an end."""
        return self.points.add(self.holder(end), wanted, end.place)

    def holder(self, end: ClosingEnd) -> str:
        """The body of the spec that an end stands on."""
        return self.tree.names[self.frames.owners[end.body]]

    def connect(self, number: int) -> None:
        data = self.c.model.eq_data[number]
        self.add(number, "ball", self.ends(number, (data[0:3], data[3:6])))

    def weld(self, number: int) -> None:
        """A weld of a spec keeps the axes of its bodies along each other, as they are at the zero of all joints."""
        data = self.c.model.eq_data[number]
        one, other = self.ends(number, (data[3:6], data[0:3]))
        of_sites = int(self.c.model.eq_objtype[number]) == int(self.c.mujoco.mjtObj.mjOBJ_SITE)
        wanted = one.attitude if of_sites else after(one.attitude, rotation(data[6:10]))
        if float(data[10]) == 0.0:  # torquescale: it holds no turn
            self.add(number, "ball", (one, other))
        elif np.abs(np.array(wanted) - np.array(other.attitude)).max() > SAME:
            cosine = (np.trace(np.array(wanted).T @ np.array(other.attitude)) - 1.0) / 2.0
            angle = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
            why = f"a weld that turns its bodies by {angle:.3g} degrees against how they are drawn is not in a spec"
            self.leave(number, why, "draw the bodies as they are welded, at the zero of the joints")
        else:
            self.add(number, "weld", (one, other))

    def couple(self, number: int) -> None:
        model = self.c.model
        slave, master = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        polynomial = tuple(float(x) for x in model.eq_data[number][:5])
        self.couplings.append(JointEquality(number, slave, master if master >= 0 else None, polynomial))

    def tendon(self, number: int) -> None:
        model = self.c.model
        tendon, other = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        sites = straight(self.c, tendon)
        if other >= 0:
            self.leave(number, "the lengths of two tendons, coupled, are not in a spec")
        elif sites is None:
            self.leave(number, f"{self.c.told('tendon', tendon)} does not run straight from one site to another")
        else:
            length = float(model.tendon_length0[tendon]) + float(model.eq_data[number][0])
            self.rods.add(tendon)
            self.carried.add(number)
            wanted = self.c.name("tendon", tendon) or f"tendon_{tendon + 1}"
            ends = self.site(sites[0]), self.site(sites[1])
            self.joint(wanted, self.c.told("tendon", tendon), "rod", ends, length=length)


def straight(c: Compiled, tendon: int) -> tuple[int, int] | None:
    """The two sites of a tendon that runs straight from one to the other; None of all others."""
    model = c.model
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    site = int(c.mujoco.mjtWrap.mjWRAP_SITE)
    if count != SITES or any(int(model.wrap_type[k]) != site for k in range(first, first + count)):
        return None
    return int(model.wrap_objid[first]), int(model.wrap_objid[first + 1])


def moved(polynomial: tuple[float, ...], argument: str) -> str:
    """The polynomial of an argument, as an expression."""
    return " + ".join(_terms(polynomial, argument)) or "0"


def _terms(polynomial: tuple[float, ...], argument: str) -> Iterator[str]:
    for power, factor in enumerate(polynomial):
        if factor:
            yield (
                pointed(factor) if power == 0 else f"{pointed(factor)}*{argument}" + (f"**{power}" if power > 1 else "")
            )
