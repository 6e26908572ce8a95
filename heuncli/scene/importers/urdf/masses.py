"""Validate the mass properties of links as those of rigid bodies, and repair those faults that --repair names.

    A1 <= A2 <= A3, principal moments:    0 <= A1,  A3 <= A1 + A2

Without repair, the moments may violate this by what heun accepts as rounding. A repair changes as little as possible:

    negative    moments below 0 become 0
    triangle    A1 and A2 are raised, each by half of A3 - A1 - A2, which minimizes the sum of squares of the changes
    zero        a link with a mass and no moment at all becomes a point mass
    massless    a link without mass that moves gets a point mass of REPAIRED_MASS at its origin; a mass of 0
                loses its inertia
"""

from __future__ import annotations

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import ZERO, Matrix, Vec
from heuncli.scene.file_format.rotations import symmetric_eigenvalues
from heuncli.scene.importers.attitudes import round_number
from heuncli.scene.importers.spec_text import format_number
from heuncli.scene.importers.urdf.document import Inertial, UrdfLink
from heuncli.scene.importers.urdf.fields import UrdfFields

REPAIRED_MASS = 1e-6  # [kg] mass given to a massless link that moves: below the last digit of robot masses


class LinkMass(NamedTuple):
    """mass: [kg]
    center: centre of mass in the link's frame [m]
    rpy: roll, pitch, yaw of the inertia's axes [rad]
    inertia: about the centre of mass, in those axes [kg m^2]
    notes: remarks by key
    """

    mass: float
    center: Vec
    rpy: Vec
    inertia: Matrix
    notes: dict[str, str]


def validate_mass(link: UrdfLink, repair: frozenset[str], fields: UrdfFields) -> LinkMass | None:
    """Return the validated mass properties of a link; None if it has none, or if they are wrong, which is then a
    problem.
    """
    inertial = link.inertial
    if inertial is None or (inertial.mass == 0.0 and not any(inertial.moments)):
        return None  # explicitly without mass
    if inertial.mass == 0.0 and "massless" in repair:
        fields.links_without_inertia[link.name] = None
        return None
    if inertial.mass <= 0.0:
        message = "the mass is 0, the inertia is not" if inertial.mass == 0.0 else f"the mass is {inertial.mass:g} kg"
        hint = "a moving link needs a mass above 0; leave out <inertial> for a frame without mass"
        if inertial.mass == 0.0:
            hint += "; --repair massless leaves the inertia out"
        fields.report("import-mass", inertial.element, link.path, message, hint)
        return None
    validation = _InertiaValidation(link, inertial, repair, fields)
    validation.check_zero()
    validation.check_negative()
    validation.check_triangle()
    return LinkMass(inertial.mass, inertial.pose.xyz, inertial.pose.rpy, validation.inertia, validation.notes)


class _InertiaValidation:
    """The inertia of one link while it is checked for three faults."""

    def __init__(self, link: UrdfLink, inertial: Inertial, repair: frozenset[str], fields: UrdfFields) -> None:
        self.link, self.inertial, self.repair, self.fields = link, inertial, repair, fields
        self.inertia = _make_tensor(inertial.moments)
        self.repairs_done: list[str] = []
        self.notes: dict[str, str] = {}

    def check_zero(self) -> None:
        """Check that some moment is not 0. A moment of 0 about one axis is a thin rod, which is a valid body."""
        if not any(self.inertial.moments):
            if "zero" in self.repair:
                self.notes["inertia"] = "repaired (zero): a point mass; all moments are 0 in the file"
            else:
                self.report(
                    f"all moments of inertia are 0, but the mass is {self.inertial.mass:g} kg",
                    "zero",
                    "makes it a point mass",
                )
        elif (moments := symmetric_eigenvalues(self.inertia))[0] == 0.0 and moments[2] - moments[1] <= self.tolerance(
            "triangle"
        ):
            self.notes["inertia"] = "a thin rod: no moment of inertia about its axis"

    def check_negative(self) -> None:
        """Check that no principal moment is below 0."""
        moments = symmetric_eigenvalues(self.inertia)
        if moments[0] >= -self.tolerance("negative"):
            return
        if "negative" in self.repair:
            least, middle, most = (max(moment, 0.0) for moment in moments)
            self.replace_moments("negative", (least, middle, most))
        else:
            self.report(
                f"a principal moment of inertia is negative: {_format_moments(moments)} kg m^2",
                "negative",
                "sets it to 0",
            )

    def check_triangle(self) -> None:
        """Check that no principal moment exceeds the sum of the other two."""
        least, middle, most = moments = symmetric_eigenvalues(self.inertia)
        excess = most - least - middle
        if excess <= self.tolerance("triangle") or least < -self.tolerance("negative"):  # reported already if negative
            return
        if "triangle" in self.repair:
            self.replace_moments("triangle", (least + excess / 2.0, middle + excess / 2.0, most))
        else:
            message = f"no body has the principal moments {_format_moments(moments)} kg m^2: "
            message += "none may exceed the sum of the others"
            self.report(message, "triangle", "increases the two smaller ones")

    def tolerance(self, word: str) -> float:
        """Return the accepted violation of a rule [kg m^2]; after a repair, it is that of typed digits."""
        share = tolerances.INERTIA_TYPED if word in self.repair else tolerances.INERTIA_REFUSED
        return share * max(map(abs, symmetric_eigenvalues(self.inertia)))

    def report(self, message: str, word: str, effect: str) -> None:
        hint = f"check the exporting program; --repair {word} {effect} and notes this next to the value"
        self.fields.report("import-inertia", self.inertial.element, self.link.path, message, hint)

    def replace_moments(self, word: str, moments: Vec) -> None:
        """Set other principal moments, ascending, about the same axes, and note both."""
        self.repairs_done.append(word)
        old = _format_moments(symmetric_eigenvalues(_make_tensor(self.inertial.moments)))
        words = ", ".join(self.repairs_done)
        self.notes["inertia"] = f"repaired ({words}): principal moments {_format_moments(moments)}; the file has {old}"
        self.inertia = _replace_principal_moments(self.inertia, moments)


def _replace_principal_moments(inertia: Matrix, moments: Vec) -> Matrix:
    """Return the tensor of the same principal axes with other moments, ascending."""
    size = max(map(abs, moments))
    if all(inertia[i][j] == 0.0 for i, j in ((0, 1), (0, 2), (1, 2))):
        order = sorted(range(3), key=lambda i: inertia[i][i])
        given = {axis: round_number(moment, size) for axis, moment in zip(order, moments, strict=True)}
        return (given[0], 0.0, 0.0), (0.0, given[1], 0.0), (0.0, 0.0, given[2])
    import numpy as np  # takes 50 ms, and only such a file needs it

    _, axes = np.linalg.eigh(np.array(inertia))  # ascending, as the moments are
    tensor = (axes * np.array(moments)) @ axes.T
    rows = [[round_number(float(tensor[i][j] + tensor[j][i]) / 2.0, size) for j in range(3)] for i in range(3)]
    return tuple(map(tuple, rows))  # type: ignore[return-value]


def _make_tensor(moments: tuple[float, ...]) -> Matrix:
    xx, yy, zz, xy, xz, yz = moments
    return (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)


def _format_moments(moments: Vec) -> str:
    return ", ".join(format_number(float(f"{moment:.6g}")) for moment in moments)


def make_repaired_mass(link: UrdfLink) -> LinkMass:
    """Make the mass properties that the repair `massless` gives a link without mass."""
    reason = "has no mass" if link.inertial is None else "has mass 0"
    notes = {"mass": f"repaired (massless): the link {reason} in the file"}
    return LinkMass(REPAIRED_MASS, ZERO, ZERO, (ZERO, ZERO, ZERO), notes)
