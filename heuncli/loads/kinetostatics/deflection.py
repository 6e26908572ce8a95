"""Compute how a bar bends under its section loads, and how safe it is against buckling, after the rigid solution.

Bernoulli's beam: with w1, w2 the displacements of its axis along e1, e2, s the distance along n, E Young's modulus,

    (w1'', w2'') = K (M2, -M1)/E,   K = [int y1^2, int y1 y2; int y1 y2, int y2^2]^-1

moments about the centroid; along principal axes w1'' = M2/(E I2), w2'' = -M1/(E I1). (Timoshenko, Strength of
Materials, part I.) From the moments at the nodes of a stretch (loads/kinetostatics/stretch.py) two integrations in
Chebyshev polynomials give slope and deflection anywhere: exactly for a constant K, and where K changes on pieces that
are halved until it is resolved.

A rigid body has no tangent of its own: the reference decides where deflection and slope are zero.

Buckling by Euler: pi^2 E I/(factor L)^2 over the largest compression along the series of cuts, with the least I of any
cut.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, Problem, SpecError
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.auto_properties import CutProperties
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.cut_planes import list_attachments, list_distributed_loads
from heuncli.loads.kinetostatics.cuts import Beam, Cuts
from heuncli.loads.kinetostatics.member_stress import find_given_factors
from heuncli.loads.kinetostatics.piece_loads import (
    AttachedLoad,
    find_acceleration_matrix,
    find_piece_loads,
    shift_moment,
)
from heuncli.loads.kinetostatics.sections import compute_axis_component, make_cut_places
from heuncli.loads.kinetostatics.stress import MODULI
from heuncli.loads.kinetostatics.stretch import (
    DEGREE,
    NODES,
    TO_COEFFICIENTS,
    Stretch,
    chebyshev_polynomials,
    find_peaks,
    make_cuts_at,
    make_stretch,
)
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.file_format.models import BeamTheory, Spec
from heuncli.scene.file_format.profiles import FAMILIES

HALVINGS = 12  # of pieces, until the compliance is a polynomial: a 4096th of a taper
MAX_PIECES = 4096  # the most pieces of a stretch
COMPLIANCE_ERROR = tolerances.QUADRATURE * 1e3  # relative to the largest of a piece
CHECKED = np.array([-0.93, -0.45, 0.1, 0.62, 0.97])
# Chebyshev coefficients of the first and second integral from -1 of each T_k, in columns
ONCE = np.asarray(np.polynomial.chebyshev.chebint(np.eye(DEGREE + 1), lbnd=-1), dtype=np.float64)
TWICE = np.asarray(np.polynomial.chebyshev.chebint(np.eye(DEGREE + 1), m=2, lbnd=-1), dtype=np.float64)


def add_beams(all_cuts: Sequence[Cuts], mechanism: Mechanism, spec: Spec) -> tuple[Cuts, ...]:
    """Return all cuts, with their beams where a deflection is computed. Raises SpecError where that is impossible."""
    found: list[Cuts] = []
    for cuts in all_cuts:
        section = spec.sections[cuts.name]
        try:
            theory = section.beam_theory
            found.append(cuts if theory is None else replace(cuts, beam=make_beam(cuts, theory, mechanism)))
        except Finding as finding:
            place, message = spec.location(f"sections.{cuts.name}"), f"{section.body}: {finding.message}"
            raise SpecError(Problem(finding.code, message, place, finding.hint)) from finding
    return tuple(found)


def make_beam(cuts: Cuts, theory: BeamTheory, mechanism: Mechanism) -> Beam:
    """Make the beam of a series of cuts.

    Raises Finding where its compliance is unbounded or changes too fast to integrate.
    """
    points = [attachment.place for attachment in list_attachments(mechanism, cuts.body)]
    lines = [line.place for line in list_distributed_loads(mechanism, cuts.body)]
    corners = make_stretch(cuts, points, lines).corners
    for _ in range(HALVINGS):
        is_resolved = find_resolved(cuts, corners)
        if is_resolved.all() or len(corners) > MAX_PIECES:
            break
        middles = 0.5 * (corners[1:] + corners[:-1])
        corners = np.sort(np.concatenate([corners, middles[~is_resolved]]))
    if not find_resolved(cuts, corners).all():
        message = "the second moment of area falls to nearly zero along the run, or changes too fast for beam theory"
        raise Finding("no-deflection", message, "end the run before the tip")
    nodes = make_plain_stretch(cuts, corners).fixed_cuts
    weakest = float(np.linalg.eigvalsh(find_compliance(nodes))[..., -1].max())
    free_length = theory.length_factor * float(corners[-1] - corners[0])
    return Beam(theory, cuts, corners, nodes, math.pi**2 * theory.modulus / (weakest * free_length**2))


def make_plain_stretch(cuts: Cuts, corners: Array) -> Stretch:
    """Make a stretch for its nodes alone, without the places where loads jump."""
    return Stretch(cuts, corners, np.full(len(corners), False))


def find_resolved(cuts: Cuts, corners: Array) -> Mask:
    """Return whether the compliance, also times a cubic as moments are, is the polynomial of its nodes, on each piece.

    corners (m + 1,): heights along n
    """
    a, b = corners[:-1, None], corners[1:, None]
    x = np.concatenate([NODES, CHECKED])
    heights = 0.5 * (a + b) + 0.5 * (b - a) * x
    side = np.tile(np.concatenate([[-1.0], np.zeros(DEGREE - 1), [1.0], np.zeros(len(CHECKED))]), len(a))
    placed = make_cuts_at(cuts, (heights - cuts.points[0] @ cuts.n).ravel(), side)
    compliance = find_compliance(placed).reshape(*heights.shape, 4)
    values = np.concatenate([compliance, compliance * x[:, None] ** 3], axis=-1)
    expected = np.einsum("cj,pje->pce", chebyshev_polynomials(CHECKED) @ TO_COEFFICIENTS, values[:, : len(NODES)])
    errors = np.abs(expected - values[:, len(NODES) :]).max(axis=(1, 2))
    is_short = (b - a)[:, 0] <= tolerances.SAME_CUT * (corners[-1] - corners[0])
    return np.asarray(is_short | (errors <= COMPLIANCE_ERROR * np.abs(compliance).max(axis=(1, 2))))


def find_compliance(cuts: Cuts) -> Array:
    """Return K (..., k, 2, 2) [1/m4] of cuts (..., k): the inverse of the second moments of area along e1, e2."""
    assert cuts.properties is not None
    kind, values = cuts.properties
    shape = cuts.points.shape[:-1]
    if kind == "auto":
        return find_auto_compliance(cuts.auto_properties, math.prod(shape)).reshape(*shape, 2, 2)
    K = find_given_factors(kind, values).inverse if kind in FAMILIES else find_principal_compliance(kind, values)
    return np.broadcast_to(K, (*shape, 2, 2))


def find_principal_compliance(kind: str, values: Mapping[str, float | Array]) -> Array:
    """Return K (..., 2, 2) of a section with principal axes e1, e2."""
    moduli = MODULI[kind](values)
    I1, I2 = np.broadcast_arrays(moduli.I1, moduli.I2)
    K = np.zeros((*I1.shape, 2, 2))
    with np.errstate(divide="ignore"):
        K[..., 0, 0], K[..., 1, 1] = 1.0 / I2, 1.0 / I1
    return K


def find_auto_compliance(properties: CutProperties, count: int) -> Array:
    """Return K (count, 2, 2) of cuts through shapes; nan where it is not known."""
    K = np.full((count, 2, 2), np.nan)
    for group in properties.groups:
        if group.member is not None:
            turn = np.array(group.frame).reshape(2, 2)
            K[group.cut_mask] = turn @ group.member.inverse @ turn.T
            continue
        own = find_principal_compliance(group.kind, group.values)
        K[group.cut_mask] = np.broadcast_to(own, K.shape)[group.cut_mask]
    return K


def make_deflection_block(
    cuts: Cuts,
    states: BodyStates,
    gravity: Array,
    attached_loads: Sequence[AttachedLoad],
    find_open: Callable[[Cuts], Mapping[str, Mask]],
    planar: bool = False,
) -> Block:
    """Return deflections and slopes at the cuts of a series, (n_t, k), and its safety against buckling, (n_t,).

    find_open: returns which loads of cuts are indeterminate, (n_t, k) by name; what depends on them is nan
    """
    assert cuts.beam is not None and cuts.s is not None
    beam, theory = cuts.beam, cuts.beam.theory
    nodes = beam.nodes
    if any(load.point.ndim == 2 for load in attached_loads):
        nodes = make_plain_stretch(beam.series, beam.corners).place_for_loads(attached_loads)
    force, moment = find_piece_loads(nodes, find_acceleration_matrix(cuts.body, states, gravity), attached_loads)
    if planar:
        force[2], moment[:2] = 0.0, 0.0
    places = make_cut_places(nodes, states)
    moment = shift_moment(force, moment, places.centroids - places.cut_points)
    is_open = find_open(nodes)
    rows = {"N": (nodes.n, force), "M10": (nodes.e1, moment), "M20": (nodes.e2, moment)}
    N, M1, M2 = (
        np.where(is_open[name], np.nan, compute_axis_component(axis, v))
        if name in is_open
        else compute_axis_component(axis, v)
        for name, (axis, v) in rows.items()
    )
    K = find_compliance(nodes) / theory.modulus
    K1, K2, K12 = K[..., 0, 0], K[..., 1, 1], K[..., 0, 1]
    # along principal axes an indeterminate moment in one plane leaves the deflection in the other determinate
    is_principal = np.abs(K12) <= tolerances.PRINCIPAL * np.sqrt(K1 * K2)
    curvatures = K1 * M2 - np.where(is_principal, 0.0, K12 * M1), np.where(is_principal, 0.0, K12 * M2) - K2 * M1
    block: dict[str, Array] = {}
    for number, curvature in enumerate(curvatures, 1):
        assert nodes.s is not None
        w, slope = integrate_twice(curvature, nodes.s, cuts.s, beam.length, theory.reference)
        block[f"w{number}"], block[f"slope{number}"] = w, slope
    return {"deflection": block, "buckling": find_buckling_safety(N, beam.euler_load)}


def integrate_twice(
    curvature: Array, nodes: Array, s: Array, length: float, reference: str = "start"
) -> tuple[Array, Array]:
    """Return deflection [m] and slope [rad] (n_t, k) at distances s (k,) or (n_t, k) from the start of a series.

    curvature (n_t, 9 m): at the nodes (9 m,) or (n_t, 9 m), distances [m] from its start, of m pieces
    reference: chord: the deflection is 0 at both ends; start, end: deflection and slope are 0 there

    Of a piece too short for results all nodes are elsewhere, at one place (stretch.py): it is left out.
    """
    n_t = len(curvature)
    c = curvature.reshape(n_t, -1, DEGREE + 1) @ TO_COEFFICIENTS.T
    once, twice = c @ ONCE.T, c @ TWICE.T
    ends = np.broadcast_to(nodes, curvature.shape).reshape(c.shape)[..., [0, -1]]
    is_short = ends[..., 1] <= ends[..., 0]
    breaks = np.maximum.accumulate(np.where(is_short, 0.0, ends[..., 1]), axis=1)
    starts = np.concatenate([np.zeros((n_t, 1)), breaks[:, :-1]], axis=1)
    h = 0.5 * (breaks - starts)
    slopes = accumulate_steps(h * once.sum(axis=2))
    deflections = accumulate_steps(2.0 * h * slopes[:, :-1] + h * h * twice.sum(axis=2))
    rows = slice(None if nodes.ndim > 1 or s.ndim > 1 else 1)  # one, where nothing moves along the series
    s = np.broadcast_to(s, (n_t, s.shape[-1]))[rows]
    piece = np.minimum((breaks[rows, None] < s[..., None]).sum(axis=2), h.shape[1] - 1)

    def take(values: Array) -> Array:
        return np.take_along_axis(values, np.broadcast_to(piece, (len(values), s.shape[1])), axis=1)

    own_h = take(h[rows])
    x = np.clip((s - take(starts[rows])) / np.where(own_h > 0.0, own_h, 1.0) - 1.0, -1.0, 1.0)
    angle = np.arccos(x)
    slope, w = take(slopes), take(deflections) + own_h * (x + 1.0) * take(slopes)
    for k in range(DEGREE + 3):
        polynomial = np.cos(k * angle)
        w = w + own_h * own_h * take(twice[..., k]) * polynomial
        if k < DEGREE + 2:
            slope = slope + own_h * take(once[..., k]) * polynomial
    last_w, last_slope = deflections[:, -1:], slopes[:, -1:]
    if reference == "chord":
        return w - s / length * last_w, slope - last_w / length
    if reference == "end":
        return w - last_w - last_slope * (s - length), slope - last_slope
    return w, slope


def accumulate_steps(steps: Array) -> Array:
    """Return 0 and the sums of the first steps, (n_t, m + 1) of (n_t, m)."""
    return np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)], axis=1)


def find_buckling_safety(N: Array, euler_load: float) -> Array:
    """Return Euler's load over the largest compression along a series, (n_t,), from the normal forces at its nodes.

    `tolerances.GREATEST_SAFETY` stands for all that is larger, and for tension, which has no bound.
    """
    compression = find_peaks(N)[0].height
    is_bounded = compression * tolerances.GREATEST_SAFETY > euler_load
    safety = np.where(is_bounded, euler_load / np.where(is_bounded, compression, 1.0), tolerances.GREATEST_SAFETY)
    return np.where(np.isnan(compression), np.nan, safety)
