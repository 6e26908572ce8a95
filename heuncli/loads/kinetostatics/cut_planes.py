"""Place the cuts of each section of a spec: their planes and sides, and the pieces that they separate.

A series of cuts has one normal. Where a joint, load or point mass lies in the plane of a cut, the section loads jump:
two cuts are made there, just before and just beyond it; at the ends of the series only the inner one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.cuts import SEPARATE, Cuts
from heuncli.multibody.mechanism.loads import GROUND, PointLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import BEFORE, BEYOND, SIDE_SIGNS, Array
from heuncli.scene.file_format.models import Section, Spec
from heuncli.scene.shapes.composite_solid import NO_MATTER, CompositeSolid
from heuncli.scene.shapes.inertia import pseudo_inertia
from heuncli.scene.shapes.rotations import cross_vectors
from heuncli.scene.shapes.section_axes import make_first_axis

if TYPE_CHECKING:
    pass


class Attachment(NamedTuple):
    """What acts on a body, and where: a joint, force, impulse or stop with its name; a point (3,), body axes.

    Of a distributed load: the two ends of its line (2, 3).
    """

    kind: Literal["joint", "force", "impulse", "stop"]
    name: str
    place: Array

    @property
    def label(self) -> str:
        """Its kind and name."""
        return f"{self.kind} {self.name}"


def list_attachments(mechanism: Mechanism, body: int) -> list[Attachment]:
    """List loads, impulses, joints and stops with their points, body axes.

    A joint whose point of action moves over the body is left out, except where it comes to a stop.
    """
    points: list[Attachment] = []
    for joint in mechanism.joints:
        if joint.b == body:
            points.append(Attachment("joint", joint.name, joint.q))
        if joint.a == body and not JOINTS[joint.kind].has_moving_contact:
            points.append(Attachment("joint", joint.name, joint.p))
    for load in mechanism.loads:
        if isinstance(load, PointLoad) and load.spread is not None:
            continue
        points += [Attachment("force", load.name, point) for owner, point in load.points if owner == body]
    for impulse in mechanism.impulses:
        if impulse.body == body and impulse.point is not None:
            points.append(Attachment("impulse", impulse.name, impulse.point))
    for stop in mechanism.stops:
        joint = mechanism.joints[stop.joint]
        if joint.a == body and stop.quantity == "travel":
            limits = [limit for limit in (stop.low, stop.high) if limit is not None]
            for limit in limits:
                limit_point = limit * joint.axis if joint.path is None else joint.path.evaluate(limit)[0]
                points.append(Attachment("stop", stop.name, joint.p + limit_point))
    return points


def list_distributed_loads(mechanism: Mechanism, body: int) -> list[Attachment]:
    """List the distributed loads on a body, each with the two ends of its line, (2, 3), body axes."""
    lines: dict[str, Attachment] = {}
    for load in mechanism.loads:
        if isinstance(load, PointLoad) and load.spread is not None and load.body == body:
            ends = np.stack([load.spread.start, load.spread.end])
            lines.setdefault(load.name, Attachment("force", load.name, ends))
    return list(lines.values())


def make_cuts(mechanism: Mechanism, spec: Spec, forms: dict[str, CompositeSolid]) -> tuple[Cuts, ...]:
    """Make the cuts of all sections of a spec. Raises SpecError with every section that cannot be cut."""
    cuts: list[Cuts] = []
    problems: list[Problem] = []
    index = {b.name: i for i, b in enumerate(mechanism.bodies)}
    for name, section in spec.sections.items():
        try:
            form = NO_MATTER if mechanism.bodies[index[section.body]].mass == 0.0 else forms.get(section.body)
            cuts.append(_make_section_cuts(mechanism, spec, name, section, index, form))
        except SpecError as error:
            problems += error.problems
        except Finding as finding:
            place = spec.location(f"sections.{name}")
            problems.append(Problem(finding.code, f"{section.body}: {finding.message}", place, finding.hint))
    if problems:
        raise SpecError(*problems)
    return tuple(cuts)


def _make_section_cuts(
    mechanism: Mechanism, spec: Spec, name: str, section: Section, index: dict[str, int], form: CompositeSolid | None
) -> Cuts:
    """Make the cuts of one section. Raises SpecError, Finding."""
    body = index[section.body]
    n = np.array(section.normal, dtype=float)
    n = n / np.sqrt(n @ n)
    e1 = make_first_axis(n, section.first_axis)
    points, s = _make_cut_points(section)
    d = points @ n
    attachments, lines = list_attachments(mechanism, body), list_distributed_loads(mechanism, body)
    heights = np.array([attachment.place for attachment in attachments]).reshape(-1, 3) @ n
    ends = np.array([line.place for line in lines]).reshape(-1, 2, 3) @ n
    plane_tolerance = _find_plane_tolerance(form, np.append(heights, ends), d)
    # the end of a distributed load in the plane carries nothing, but the whole line may lie there
    distances = np.concatenate([np.abs(heights - d[:, None]), np.abs(ends - d[:, None, None]).max(axis=2)], axis=1)
    in_plane = distances <= plane_tolerance
    attachments, heights = attachments + lines, np.append(heights, ends)
    jumps = np.asarray(in_plane.any(axis=1))
    if form is not None:
        jumps = jumps | form.has_mass_in_plane(n, d) | form.has_rod_in_plane(n, d)
    location = spec.location(f"sections.{name}")
    if s is None:
        if jumps[0] and section.side is None:
            names = [attachment.label for attachment, lies_in in zip(attachments, in_plane[0], strict=True) if lies_in]
            raise SpecError(_make_missing_side_problem(names, location))
        # kept also where nothing lies in the plane: joints may move into it during the run
        side = np.array([SIDE_SIGNS[section.side]])
    else:
        if s[-1] <= SEPARATE * plane_tolerance:
            message = (
                f"the run is {s[-1]:.3g} m long, but cuts of a body of this size are distinct only beyond "
                f"{plane_tolerance:.3g} m"
            )
            raise SpecError(Problem("short-run", message, location, hint="check the body's largest coordinate"))
        selected, side = _choose_cut_sides(jumps)
        points, s, d = points[selected], s[selected], d[selected]
    reach = (
        float(heights.min(initial=np.inf)) - plane_tolerance,
        float(heights.max(initial=-np.inf)) + plane_tolerance,
    )
    pieces, centroids, warnings = _make_pieces(location, name, section, form, n, points, side, reach)
    moment_reference: str | tuple[int, Array] = "at"
    if section.reduce_to == "centroid":
        moment_reference = "centroid"
    elif not isinstance(section.reduce_to, str):
        end = section.reduce_to
        moment_reference = (GROUND if end.body == "ground" else index[end.body], np.array(end.point))
    cuts = Cuts(
        name=name, body=body, n=n, e1=e1, e2=cross_vectors(n, e1), points=points, s=s, side=side,
        plane_tolerance=plane_tolerance, pieces=pieces, centroids=centroids, moment_reference=moment_reference,
        line=section.reduce_to == "line", properties=section.properties, strength=section.strength,
        warnings=warnings, form=form,
    )  # fmt: skip
    if section.properties is not None and section.properties.kind == "auto":
        _require_properties(location, cuts)
    return cuts


def _require_properties(location: SourceLocation, cuts: Cuts) -> None:
    """Raise SpecError where the properties of a cut, or of any along a series, cannot be taken from the shapes."""
    from heuncli.loads.kinetostatics.auto_properties import find_cut_properties

    cut_form = cuts.cut_form
    if cuts.s is not None and cuts.form is not None:
        low, high = float(cut_form.d[0]), float(cut_form.d[-1])
        corners = np.sort(cuts.form.corners(cuts.n))
        inside = (corners > low + cuts.plane_tolerance) & (corners < high - cuts.plane_tolerance)
        ends = np.concatenate([[low], corners[inside], [high]])
        d = np.concatenate([ends[:-1], 0.5 * (ends[1:] + ends[:-1]), ends[1:]])
        side = np.repeat([BEYOND, 0.0, BEFORE], len(ends) - 1)
        is_long = np.tile(np.diff(ends) > SEPARATE * cuts.plane_tolerance, 3)
        cut_form = replace(cut_form, d=d[is_long], side=side[is_long])
    missing = find_cut_properties(cut_form).missing
    if missing:
        k = min(missing, key=lambda k: float(cut_form.d[k]))
        where = f" at s = {float(cut_form.d[k] - cuts.points[0] @ cuts.n):.6g} m" if cuts.s is not None else ""
        hint = "give a profile, circle, tube, rectangle, or area, I1, I2, J, c1, c2; or cut at right angles to the bar"
        message = f"properties: auto cannot be determined from the shapes{where}: {missing[k]}"
        raise SpecError(Problem("no-properties", message, location, hint=hint))


def _make_cut_points(section: Section) -> tuple[Array, Array | None]:
    """Return the points of the cuts (k, 3) and their distances along the series (k,), None for a single cut."""
    if section.at is not None:
        return np.array([section.at], dtype=float), None
    first, last = np.array(section.from_), np.array(section.to)
    fraction = np.linspace(0.0, 1.0, section.count)
    points = first + fraction[:, None] * (last - first)
    points[-1] = last
    return points, fraction * float(np.sqrt((last - first) @ (last - first)))


def _find_plane_tolerance(form: CompositeSolid | None, heights: Array, d: Array) -> float:
    """Return the distance [m] up to which a point counts as in a plane: rounding of the coordinates."""
    extent = float(np.abs(heights).max(initial=0.0))
    if form is not None:
        return max(form.tolerance, tolerances.IN_PLANE * extent)
    return tolerances.IN_PLANE * max(extent, float(np.abs(d).max()), tolerances.LEAST_EXTENT)


def _make_missing_side_problem(names: list[str], location: SourceLocation) -> Problem:
    """Make the problem of a single cut with something in its plane and no side given."""
    what = " and ".join(names) if names else "a point mass or rod of the body"
    hint = "add side: before (it is then on the far side of the cut) or side: beyond (on the near side)"
    return Problem(
        "needs-side", f"{what} {'lie' if len(names) > 1 else 'lies'} in the plane of the cut", location, hint
    )


def _choose_cut_sides(jumps: NDArray[np.bool_]) -> tuple[list[int], Array]:
    """Return for each cut of a series the index of its point and its side: two cuts where the loads jump, one at the
    ends.
    """
    rows: list[tuple[int, float]] = []
    for k, jump in enumerate(jumps.tolist()):
        if not jump:
            rows.append((k, 0.0))
        elif k == 0:
            rows.append((k, BEYOND))
        elif k == len(jumps) - 1:
            rows.append((k, BEFORE))
        else:
            rows += [(k, BEFORE), (k, BEYOND)]
    return [k for k, _ in rows], np.array([side for _, side in rows])


def _make_pieces(
    location: SourceLocation,
    name: str,
    section: Section,
    form: CompositeSolid | None,
    n: Array,
    points: Array,
    side: Array,
    reach: tuple[float, float],
) -> tuple[Array, Array | None, tuple[str, ...]]:
    """Make pieces, centroids and warnings of the cuts; reach: from the smallest to the largest n.x of joints and
    loads.
    """
    if form is None:
        if section.piece is None:
            raise SpecError(Problem(
                "needs-shapes", f"the body {section.body} has no shapes to cut", location,
                hint="build the body from shapes, or give a single cut its piece: {mass, center, inertia}",
            ))  # fmt: skip
        piece = section.piece
        return pseudo_inertia(piece.mass, np.array(piece.center), np.array(piece.inertia))[None], None, ()
    if form is NO_MATTER:
        return form.piece_inertias(n, points @ n, side), None, ()
    d, is_cut_series = points @ n, section.at is None
    # the ends of a series may lie in end faces: there the inner limits are used
    inner_side = side.copy()
    if is_cut_series:
        inner_side[0], inner_side[-1] = BEYOND, BEFORE
    cross_sections = form.cross_sections(n, d, inner_side)
    is_empty = cross_sections.regions == 0
    _require_body(location, section, form, n, d[is_empty], reach)
    warnings = []
    if is_empty.any():
        meets = f"{int(is_empty.sum())} of {len(d)} cuts meet" if is_cut_series else "the plane meets"
        where = "" if section.properties is None else ", and stresses refer to the cut's point"
        what = f"{meets} no material of the body {section.body}; the loads are those of the far side{where}"
        warnings.append(f"sections.{name}: {what}")
    if (cross_sections.regions > 1).any():
        most = int(cross_sections.regions.max())
        what = f"meets the body {section.body} in {most} separate places; the loads are their sum"
        warnings.append(f"sections.{name}: the plane {what}")
    if form.has_rod_in_plane(n, d).any():
        what = f"runs along a rod of the body {section.body}; the rod's mass counts to the chosen side"
        warnings.append(f"sections.{name}: the plane {what}")
    centroids = np.where(is_empty[:, None], points, cross_sections.centroid)
    return form.piece_inertias(n, d, side), centroids, tuple(warnings)


def _require_body(
    location: SourceLocation, section: Section, form: CompositeSolid, n: Array, d: Array, reach: tuple[float, float]
) -> None:
    """Raise SpecError unless cuts at d, which meet no material, have something of the body on both sides.

    A body drawn in separate parts is one body all the same: the load between its parts is as determinate there as in a
    bar without mass. It has no centroid.
    """
    what = "a cut of the run" if section.at is None else "the plane"
    low, high = form.extent(n)
    outside = d[(d < min(low, reach[0])) | (d > max(high, reach[1]))]
    if len(outside):
        lies = float(outside[0])
        hint = f"along the normal the body extends from {low:.6g} to {high:.6g} m, the plane is at {lies:.6g} m"
        raise SpecError(Problem("misses-body", f"{what} does not intersect the body {section.body}", location, hint))
    if len(d) and section.reduce_to == "centroid":
        message = f"{what} meets no material of the body {section.body}, so it has no centroid"
        raise SpecError(
            Problem("misses-body", message, location, hint="take moments about the cut's point: reduce_to: at")
        )
