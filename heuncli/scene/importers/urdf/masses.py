"""Mass properties of links: judged as those of rigid bodies, and what of them is repaired where that was asked for.

    A1 <= A2 <= A3, principal moments:    0 <= A1,  A3 <= A1 + A2

What is left as it is may break this by what heun takes for rounding. A repair changes as little as it can:

    negative    moments below 0 become 0
    triangle    A1 and A2 are raised, each by half of A3 - A1 - A2: of all raises the one with the least squares
    zero        a link with a mass and no moment at all is taken for a point mass
    massless    a link without mass that moves gets a point mass of MASSLESS at its origin; a mass of 0 loses its
                inertia
"""

from __future__ import annotations

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Matrix, Vec
from heuncli.scene.file_format.turns import principal
from heuncli.scene.importers.attitudes import digits
from heuncli.scene.importers.spec_text import number_text
from heuncli.scene.importers.urdf.document import Inertial, UrdfLink
from heuncli.scene.importers.urdf.fields import UrdfFields

MASSLESS = 1e-6  # [kg] of what gets a mass so that it may move: below the last digit of the masses of robots


class LinkMass(NamedTuple):
    """Mass [kg], centre in the link's frame [m], inertia about it in the axes of the pose [kg m^2]; remarks by key."""

    mass: float
    center: Vec
    rpy: Vec
    inertia: Matrix
    notes: dict[str, str]


def mass_of(link: UrdfLink, repair: frozenset[str], fields: UrdfFields) -> LinkMass | None:
    """The mass properties of a link; None where it has none, or where they are wrong, which is then a problem."""
    given = link.inertial
    if given is None or (given.mass == 0.0 and not any(given.moments)):
        return None  # without mass, and says so
    if given.mass == 0.0 and "massless" in repair:
        fields.emptied[link.name] = None
        return None
    if given.mass <= 0.0:
        what = "the mass is 0, the inertia is not" if given.mass == 0.0 else f"the mass is {given.mass:g} kg"
        hint = "a link that moves has a mass above 0; a frame without mass has no <inertial>"
        if given.mass == 0.0:
            hint += "; --repair massless leaves the inertia out"
        fields.report("import-mass", given.element, link.path, what, hint)
        return None
    judged = _Judged(link, given, repair, fields)
    judged.zero()
    judged.negative()
    judged.triangle()
    return LinkMass(given.mass, given.pose.xyz, given.pose.rpy, judged.inertia, judged.notes)


class _Judged:
    """The inertia of one link on its way through the three faults that it may have."""

    def __init__(self, link: UrdfLink, given: Inertial, repair: frozenset[str], fields: UrdfFields) -> None:
        self.link, self.given, self.repair, self.fields = link, given, repair, fields
        self.inertia = _tensor(given.moments)
        self.repaired: list[str] = []
        self.notes: dict[str, str] = {}

    def zero(self) -> None:
        """No moment at all; a moment of 0 about one axis is a thin rod, which is a body."""
        if not any(self.given.moments):
            if "zero" in self.repair:
                self.notes["inertia"] = "repaired (zero): a point mass; the file has 0 for all moments"
            else:
                self.report(f"all moments are 0, of a mass of {self.given.mass:g} kg", "zero", "takes a point mass")
        elif (moments := principal(self.inertia))[0] == 0.0 and moments[2] - moments[1] <= self.bound("triangle"):
            self.notes["inertia"] = "a thin rod: no moment about its axis"

    def negative(self) -> None:
        """A moment below 0."""
        moments = principal(self.inertia)
        if moments[0] >= -self.bound("negative"):
            return
        if "negative" in self.repair:
            least, middle, most = (max(moment, 0.0) for moment in moments)
            self.change("negative", (least, middle, most))
        else:
            self.report(f"a principal moment is negative: {_listed(moments)} kg m^2", "negative", "sets it to 0")

    def triangle(self) -> None:
        """A moment above the sum of the other two."""
        least, middle, most = moments = principal(self.inertia)
        lacking = most - least - middle
        if lacking <= self.bound("triangle") or least < -self.bound("negative"):  # the latter is told already
            return
        if "triangle" in self.repair:
            self.change("triangle", (least + lacking / 2.0, middle + lacking / 2.0, most))
        else:
            message = f"no body has the principal moments {_listed(moments)} kg m^2: each is at most the sum of two"
            self.report(message, "triangle", "raises the smaller two")

    def bound(self, word: str) -> float:
        """By how much the rule may be broken [kg m^2]: what is repaired keeps it to typed digits."""
        share = tolerances.INERTIA_TYPED if word in self.repair else tolerances.INERTIA_REFUSED
        return share * max(map(abs, principal(self.inertia)))

    def report(self, message: str, word: str, does: str) -> None:
        hint = f"look into what wrote the file; --repair {word} {does}, and says so beside the number"
        self.fields.report("import-inertia", self.given.element, self.link.path, message, hint)

    def change(self, word: str, moments: Vec) -> None:
        """Take other principal moments, ascending, about the same axes; note both."""
        self.repaired.append(word)
        old = _listed(principal(_tensor(self.given.moments)))
        words = ", ".join(self.repaired)
        self.notes["inertia"] = f"repaired ({words}): principal moments {_listed(moments)}; the file has {old}"
        self.inertia = _with_moments(self.inertia, moments)


def _with_moments(inertia: Matrix, moments: Vec) -> Matrix:
    """The tensor of the same principal axes with other moments, ascending."""
    size = max(map(abs, moments))
    if all(inertia[i][j] == 0.0 for i, j in ((0, 1), (0, 2), (1, 2))):
        order = sorted(range(3), key=lambda i: inertia[i][i])
        given = {axis: digits(moment, size) for axis, moment in zip(order, moments, strict=True)}
        return (given[0], 0.0, 0.0), (0.0, given[1], 0.0), (0.0, 0.0, given[2])
    import numpy as np  # 50 ms that only such a file needs

    _, axes = np.linalg.eigh(np.array(inertia))  # ascending, as the moments are
    made = (axes * np.array(moments)) @ axes.T
    rows = [[digits(float(made[i][j] + made[j][i]) / 2.0, size) for j in range(3)] for i in range(3)]
    return tuple(map(tuple, rows))  # type: ignore[return-value]


def _tensor(moments: tuple[float, ...]) -> Matrix:
    xx, yy, zz, xy, xz, yz = moments
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def _listed(moments: Vec) -> str:
    return ", ".join(number_text(float(f"{moment:.6g}")) for moment in moments)


def without_mass(link: UrdfLink) -> LinkMass:
    """What a link without mass is given where `massless` is repaired."""
    told = "has no mass" if link.inertial is None else "has the mass 0"
    notes = {"mass": f"repaired (massless): the link {told} in the file"}
    return LinkMass(MASSLESS, ZERO, ZERO, (ZERO, ZERO, ZERO), notes)
