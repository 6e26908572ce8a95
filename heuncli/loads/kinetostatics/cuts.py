"""The cuts of a section, and the beam of a series whose deflection is computed.

A cut is a plane; the piece lies on the side that its normal n points to. cut_planes.py places the cuts of a spec.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from heuncli.base.records import record, replace
from heuncli.results.results import Array
from heuncli.scene.file_format.models import BeamTheory, Properties
from heuncli.scene.file_format.profiles import FAMILIES
from heuncli.scene.shapes.composite_solid import CompositeSolid

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.auto_properties import CutForm, CutProperties


# plane tolerances at which corners of a stretch (stretch.py) are separate: no series of cuts is shorter
SEPARATE = 4.0


class LoadAtPoint(Protocol):
    """A load on a body, with the point at which it acts."""

    @property
    def point(self) -> Array:
        """The point (3,), or (n_t, 3) if it moves over the body; body axes."""


class PlaceableCuts(Protocol):
    """What a scene may hold for a section: its Cuts or, while extremes are searched, a Stretch (stretch.py)."""

    @property
    def name(self) -> str:
        """Name of the section."""

    @property
    def body(self) -> int:
        """Number of the body that is cut."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what the planes meet."""

    @property
    def for_impulse(self) -> PlaceableCuts:
        """The same for an impulse, without stresses and energies."""

    def place_for_loads(self, attached_loads: Sequence[LoadAtPoint]) -> Cuts:
        """Return the cuts to evaluate under these loads; those of a stretch move with loads that move over the body."""


@record
class Cuts:
    """The k cuts of one section; body axes, SI.

    n: normal
    e1, e2: axes in the plane, (e1, e2, n) right-handed
    points (k, 3): points of the planes
    s (k,): distance along the series, None for a single cut
    side (k,): +1 just before what lies in the plane, -1 just beyond, 0 nothing there
    plane_tolerance: distance up to which a point counts as in the plane
    pieces (k, 4, 4): pseudo-inertias about the body's origin
    centroids (k, 3): of the cross-sections, None without shapes
    moment_reference: where moments are taken: "at", "centroid", or (body, point)
    line: whether the reduction line (`sections.reduction_line`) is reported, too
    properties, strength [Pa]: for stresses, None where not given (for kind `auto` those of the form)
    warnings: sentences on what the planes meet
    form: the shapes that are cut
    is_impulse: whether the cuts are for an impulse, which has no stresses and no kinetic energy
    beam: of a series of cuts whose deflection is computed

    Where cuts move along a body from instant to instant, points, pieces and centroids have an axis of instants first.
    """

    name: str
    body: int
    n: Array
    e1: Array
    e2: Array
    points: Array
    s: Array | None
    side: Array
    plane_tolerance: float
    pieces: Array
    centroids: Array | None
    moment_reference: str | tuple[int, Array]
    line: bool
    properties: Properties | None
    strength: float | None
    warnings: tuple[str, ...]
    form: CompositeSolid | None = None
    is_impulse: bool = False
    beam: Beam | None = None

    @cached_property
    def auto_properties(self) -> CutProperties:
        """The properties taken from the shapes, of all cuts one after the other."""
        from heuncli.loads.kinetostatics.auto_properties import find_cut_properties  # few scenes ask for them

        return find_cut_properties(self.cut_form)

    @property
    def cuts_members(self) -> bool:
        """Whether stresses are those of members, with their named points."""
        if self.properties is None or self.form is None or self.properties.kind != "auto":
            return self.properties is not None and self.properties.kind in FAMILIES
        return any(hasattr(part, "family") for part in self.form.parts)

    @property
    def cut_form(self) -> CutForm:
        """The form and the planes that cut it."""
        from heuncli.loads.kinetostatics.auto_properties import CutForm

        assert self.form is not None
        side = np.broadcast_to(self.side, self.points.shape[:-1])
        return CutForm(self.form, self.n, self.e1, (self.points @ self.n).ravel(), side.ravel())

    def place_for_loads(self, attached_loads: Sequence[LoadAtPoint]) -> Cuts:
        """Return these cuts: unlike the nodes of a stretch, they stay where they are under any loads."""
        return self

    @property
    def for_impulse(self) -> Cuts:
        """The cuts for an impulse, without stresses and energies."""
        return replace(self, properties=None, is_impulse=True, beam=None)


@record
class Beam:
    """A series of cuts whose deflection is computed (loads/kinetostatics/deflection.py).

    theory: modulus, reference and length factor
    series: its own cuts
    corners (m + 1,): heights along n, between which loads and compliance are polynomials
    nodes: the cuts between corners from which these follow, where no load moves over the body
    euler_load: [N]
    """

    theory: BeamTheory
    series: Cuts
    corners: Array
    nodes: Cuts
    euler_load: float

    @property
    def length(self) -> float:
        """Length of the series [m]."""
        return float(self.corners[-1] - self.corners[0])
