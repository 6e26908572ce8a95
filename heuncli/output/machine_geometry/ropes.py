"""The geometry of ropes in given poses: spans between points of contact, arcs on sheaves, and the sheaves themselves.

w = ((l p + sigma n x p) / |p|^2) x n        contact points of a span: at_a w from the centre on a, at_b w on b
p: from centre to centre across the axis n;  sigma = at_a - at_b;  l^2 = |p|^2 - sigma^2
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.rope_routes import Z, find_pins, normalize
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Rope
from heuncli.scene.file_format.names import GROUND

ARC_STEP = 0.1  # rad, of a drawn arc


class SpanGeometry(NamedTuple):
    """A straight span of rope between two bodies.

    p, q: its end points on a and b if axis is None; else the centres of the sheaves there
    at_a, at_b: signed radii of the sheaves about the axis [m]
    direction: 1 if the rope runs from a to b, else -1
    """

    a: str
    p: Array
    b: str
    q: Array
    axis: Array | None = None
    at_a: float = 0.0
    at_b: float = 0.0
    direction: float = 1.0


class ArcGeometry(NamedTuple):
    """The arc of a rope on a sheave, between the span of number `span` and the next one.

    body, centre: those of the sheave
    axis: the arc runs counter-clockwise about it; in the axes of the body `axis_body`
    """

    span: int
    body: str
    centre: Array
    axis_body: str
    axis: Array


class RopeGeometry(NamedTuple):
    """A rope: its spans from its first end to its last, and its arcs.

    ground_ends: the ends on the ground, each with the other end of the span there, as (body, point)
    """

    name: str
    spans: tuple[SpanGeometry, ...]
    arcs: tuple[ArcGeometry, ...]
    ground_ends: tuple[tuple[tuple[str, Array], tuple[str, Array]], ...]


def collect_ropes(mechanism: Mechanism) -> tuple[RopeGeometry, ...]:
    """Collect the ropes over sheaves and through points of an assembled mechanism."""
    names = [body.name for body in mechanism.bodies]
    bodies = dict(enumerate(names)) | {-1: GROUND}
    return tuple(_make_rope(coupling, bodies) for coupling in mechanism.couplings if coupling.entry.type == "rope")


def _make_rope(coupling: Coupling, bodies: Mapping[int, str]) -> RopeGeometry:
    """Make one rope; between two sheaves that grip the rope, each constraint row has its own spans."""
    spans: list[SpanGeometry] = []
    arcs: list[ArcGeometry] = []
    for row in coupling.loading_rows:
        first = len(spans)
        spans += [_make_span(part, bodies) for part in row.parts if not part.lies_on_sheave]
        for part in row.parts:
            sign, ends = float(np.sign(part.radius)), (bodies[part.a], np.asarray(part.p))
            if part.kind == "arc":
                arcs.append(ArcGeometry(first + part.strand, *ends, bodies[part.a], sign * np.asarray(part.e)))
            elif part.kind == "wound" and part is row.parts[-1]:  # an arriving end: opposite sign
                arcs.append(ArcGeometry(len(spans) - 1, *ends, bodies[part.c], -sign * np.asarray(part.g)))
    assert isinstance(coupling.entry, Rope)
    end_guides = coupling.entry.through[0], coupling.entry.through[-1]
    runs = order_span_ends(spans[0]), order_span_ends(spans[-1])[::-1]
    ground_ends = tuple(run for run, x in zip(runs, end_guides, strict=True) if x.end.body == GROUND and not x.radius)
    return RopeGeometry(
        coupling.name, tuple(spans), tuple(arc for arc in arcs if arc.span + 1 < len(spans)), ground_ends
    )


def _make_span(part: CouplingPart, bodies: Mapping[int, str]) -> SpanGeometry:
    """Make a span from its coupling part (kernel/sheaves.py)."""
    ends = bodies[part.a], np.asarray(part.p), bodies[part.b], np.asarray(part.q)
    if part.kind == "rod":
        return SpanGeometry(*ends)
    at_a, at_b, direction = (float(x) for x in part.g)
    return SpanGeometry(*ends, np.asarray(part.e), at_a, at_b, direction)


def order_span_ends(span: SpanGeometry) -> tuple[tuple[str, Array], tuple[str, Array]]:
    """Return the end points of a span, or the sheave centres there, in the running direction of the rope."""
    ends = (span.a, span.p), (span.b, span.q)
    return ends if span.direction > 0.0 else (ends[1], ends[0])


def iter_sheaves(mechanism: Mechanism) -> Iterator[tuple[str, Disc]]:
    """Yield all sheaves, each with its body or the ground; those on which the rope slides get no spokes."""
    index = {body.name: i for i, body in enumerate(mechanism.bodies)} | {GROUND: -1}
    for coupling in mechanism.couplings:
        for guide in coupling.entry.through if isinstance(coupling.entry, Rope) else ():
            if guide.radius:
                point = np.array(guide.end.point)
                axis = Z if guide.axis is None else normalize(np.array(guide.axis))
                if guide.axis is None and not mechanism.planar:
                    axis = find_pins(mechanism, index[guide.end.body], point)[0][1]
                yield guide.end.body, Disc(point, axis, guide.radius, has_spokes=guide.grips)


def compute_span_ends(rope: RopeGeometry, poses: Poses) -> Array:
    """Compute the ends of a rope's spans at all instants, (n, spans, 2, 3), in the running direction of the rope."""
    return np.stack([_compute_ends(span, poses) for span in rope.spans], axis=1)


def _compute_ends(span: SpanGeometry, poses: Poses) -> Array:
    """Compute the two ends of a span, (n, 2, 3); on sheaves, where the common tangent touches them (formulas above)."""
    P, Q = poses.trace_point(span.a, span.p), poses.trace_point(span.b, span.q)
    if span.axis is None:
        return np.stack([P, Q], axis=1)
    n = poses.trace_direction(span.a, span.axis)
    D = Q - P
    p = D - np.sum(n * D, axis=1, keepdims=True) * n
    sigma, square = span.at_a - span.at_b, np.sum(p * p, axis=1, keepdims=True)
    l = np.sqrt(np.maximum(square - sigma**2, 0.0))
    w = np.cross((l * p + sigma * np.cross(n, p)) / np.where(square > 0.0, square, 1.0), n)
    ends = np.stack([P + span.at_a * w, Q + span.at_b * w], axis=1)
    return ends if span.direction > 0.0 else ends[:, ::-1]


def iter_rope_lines(rope: RopeGeometry, poses: Poses, k: int) -> Iterator[Array]:
    """Yield the spans of a rope and its arcs on sheaves at an instant, (n, 3) each."""
    ends = compute_span_ends(rope, poses)[k]
    yield from ends
    for arc in rope.arcs:
        centre, axis = poses.locate_points(arc.body, arc.centre, k), poses.trace_direction(arc.axis_body, arc.axis)[k]
        yield _make_arc_line(centre, axis, ends[arc.span, 1], ends[arc.span + 1, 0])


def _make_arc_line(C: Array, n: Array, start: Array, end: Array) -> Array:
    """Make an arc (n, 3) about an axis n through C from one point to another, counter-clockwise about n."""
    r, end_arm = start - C, end - C
    angle = np.arctan2(float(n @ np.cross(r, end_arm)), float(r @ end_arm)) % (2.0 * np.pi)
    steps = np.linspace(0.0, angle, max(2, int(np.ceil(angle / ARC_STEP)) + 1))[:, None]
    return np.asarray(C + np.cos(steps) * r + np.sin(steps) * np.cross(n, r))
