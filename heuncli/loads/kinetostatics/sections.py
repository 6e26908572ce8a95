"""Make the section loads of a moving body: their components, places and axes, stresses, and the reduction line.

    N = s'.n (tension > 0), Q1 = s'.e1, Q2 = s'.e2, T = M'.n, M1 = M'.e1, M2 = M'.e2

s', M': force and moment of the piece beyond the cut on the remainder (piece_loads.py); n points into the piece.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.piece_loads import (
    AttachedLoad,
    allocate,
    compute_piece_energy,
    find_acceleration_matrix,
    find_piece_loads,
    shift_moment,
    to_body_axes,
)
from heuncli.loads.kinetostatics.stress import MODULI, compute_stresses
from heuncli.results.results import SIDE_WORDS, Array, Block, Mask
from heuncli.scene.file_format.profiles import FAMILIES
from heuncli.scene.shapes.rotations import cross_first_axis


@record
class CutPlaces:
    """Where the cuts of a body are and where their moments are taken, (3, n_t, k), body axes [m].

    cut_points: the cuts' own points
    moment_points: where moments are reported
    centroids: the centroids, where there are shapes, else `cut_points`
    R (n_t, 3, 3), origin (n_t, 3): the body's attitude and position
    """

    cuts: Cuts
    R: Array
    origin: Array
    cut_points: Array
    moment_points: Array
    centroids: Array

    def to_world_axes(self, v: Array, output: Array | None = None, is_position: bool = False) -> Array:
        """Return world components (n_t, k, 3) of a vector (3, n_t, k) in body axes, or of a position from the
        origin.
        """
        world = np.empty(v.shape) if output is None else output
        if v.ndim == 3 and v.strides[1] == 0:  # the same at all instants: one product
            np.matmul(self.R.transpose(1, 0, 2), v[:, 0], out=world)
        else:
            before_cuts = (*range(1, v.ndim - 1), 0, v.ndim - 1)
            np.matmul(self.R, v.transpose(before_cuts), out=world.transpose(before_cuts))
        if is_position:
            world += self.origin.T[:, :, None]
        return world.transpose(*range(1, v.ndim), 0)

    def shift_wrench(self, force: Array, moment: Array) -> tuple[Array, Array]:
        """Return loads given about the cuts' points, with moments about the reported points, body axes."""
        return force, moment if self.moment_points is self.cut_points else shift_moment(
            force, moment, self.moment_points - self.cut_points
        )

    def compute_components(self, force: Array, moment: Array) -> Block:
        """Return all components of loads given about the cuts' points; T0, M10, M20 about the centroid, for
        stresses.
        """
        _, moments = self.shift_wrench(force, moment)
        cuts = self.cuts
        space = allocate(15, *force.shape[1:])
        block: Block = {
            "force": self.to_world_axes(force, space[9:12]),
            "moment": self.to_world_axes(moments, space[12:15]),
        }
        rows = [
            ("N", cuts.n, force),
            ("Q1", cuts.e1, force),
            ("Q2", cuts.e2, force),
            ("T", cuts.n, moments),
            ("M1", cuts.e1, moments),
            ("M2", cuts.e2, moments),
        ]
        if cuts.properties is not None:
            centroid_moments = (
                moment
                if self.centroids is self.cut_points
                else shift_moment(force, moment, self.centroids - self.cut_points)
            )
            rows += [
                ("T0", cuts.n, centroid_moments),
                ("M10", cuts.e1, centroid_moments),
                ("M20", cuts.e2, centroid_moments),
            ]
        for output, (name, axis, v) in zip(space, rows, strict=False):
            block[name] = compute_axis_component(axis, v, output)
        return block


def compute_axis_component(axis: Array, v: Array, output: Array | None = None) -> Array:
    """Return axis . v of vectors (3, n_t, k), (n_t, k); terms with a zero in axis are skipped."""
    (first, x), *rest = [(i, x) for i, x in enumerate(axis.tolist()) if x != 0.0]
    component: Array = np.multiply(v[first], x, out=output)
    for i, x in rest:
        component += x * v[i]
    return component


def make_cut_places(cuts: Cuts, states: BodyStates) -> CutPlaces:
    """Return the points of the cuts, of their moments and their centroids at the requested instants."""
    R, x = states.R[:, cuts.body], states.x[:, cuts.body]
    shape = (3, len(R), cuts.points.shape[-2])

    def over_instants(points: Array) -> Array:
        moves = points.ndim == 3
        return np.broadcast_to(points.transpose(2, 0, 1) if moves else points.T[:, None], shape)

    cut_points = over_instants(cuts.points)
    centroids = cut_points if cuts.centroids is None else over_instants(cuts.centroids)
    moment_points = centroids if cuts.moment_reference == "centroid" else cut_points
    if not isinstance(cuts.moment_reference, str):
        owner, point = cuts.moment_reference
        moment_points = np.broadcast_to(to_body_axes(R, states.point_position(owner, point) - x).T[:, :, None], shape)
    return CutPlaces(cuts, R, x, cut_points, moment_points, centroids)


MOMENTS = frozenset({"moment", "T", "M1", "M2", "T0", "M10", "M20"})
ABOUT_CENTROID = ("T0", "M10", "M20")


def compute_static_components(cuts: Cuts, states: BodyStates, attached_loads: Sequence[AttachedLoad]) -> Block:
    """Return section loads of the attached loads alone, without weight and inertia: (n_t, k), (n_t, k, 3)."""
    return make_cut_places(cuts, states).compute_components(
        *find_piece_loads(cuts, np.zeros((3, len(states.x), 4)), attached_loads)
    )


def make_section_block(
    cuts: Cuts,
    states: BodyStates,
    gravity: Array,
    attached_loads: Sequence[AttachedLoad],
    indeterminate_masks: Mapping[str, Mask],
    planar: bool = False,
) -> Block:
    """Make the block of one section: of a single cut without an axis of cuts, of a series with `s` and `side`.

    indeterminate_masks: by names of `CutPlaces.compute_components`; their values become nan
    """
    cut_places = make_cut_places(cuts, states)
    force, moment = find_piece_loads(cuts, find_acceleration_matrix(cuts.body, states, gravity), attached_loads)
    if planar:
        force[2], moment[:2] = 0.0, 0.0
    components = {
        name: np.where(indeterminate_masks[name], np.nan, value) if name in indeterminate_masks else value
        for name, value in cut_places.compute_components(force, moment).items()
    }
    about_centroid = {name[:-1]: components.pop(name) for name in ABOUT_CENTROID if name in components}
    block: Block = {
        "point": cut_places.to_world_axes(cut_places.moment_points, is_position=True),
        "normal": cut_places.R @ cuts.n,
        "first_axis": cut_places.R @ cuts.e1,
        "open": [],
    } | components
    if not cuts.is_impulse:
        block["energy"] = compute_piece_energy(cuts, states)
    if cuts.properties is not None:
        block["stress"] = compute_stresses_of_cuts(
            cuts, {name: components[name] for name in ("N", "Q1", "Q2")} | about_centroid
        )
    if cuts.line:
        is_determinate = np.isfinite(np.sum([components[name] for name in ("N", "Q1", "Q2", "T", "M1", "M2")], axis=0))
        line = find_reduction_line(cut_places, force, moment)
        block["line"] = {
            k: np.where(is_determinate[..., None] if v.ndim == 3 else is_determinate, v, np.nan)
            for k, v in line.items()
        }
    if cuts.s is None:
        for key in ({"point", "energy"} & block.keys()) | components.keys():
            block[key] = block[key][:, 0]
        for part in {"line", "stress"} & block.keys():
            block[part] = take_first_cut(block[part])
        return block
    return {"s": cuts.s, "side": [SIDE_WORDS[x] for x in cuts.side.tolist()]} | block


def take_first_cut(block: Block) -> Block:
    """Return the numbers of a single cut without the axis of cuts."""
    return {key: take_first_cut(value) if isinstance(value, dict) else value[:, 0] for key, value in block.items()}


def compute_stresses_of_cuts(cuts: Cuts, loads: Mapping[str, Array]) -> Block:
    """Return the stresses of all cuts, from the given properties or from those of the shapes."""
    assert cuts.properties is not None
    if cuts.properties.kind == "auto":
        from heuncli.loads.kinetostatics.auto_properties import make_stress_block

        return make_stress_block(cuts.auto_properties, cuts.points.shape[:-1], loads, cuts.strength)
    kind, values = cuts.properties
    if kind in FAMILIES:
        from heuncli.loads.kinetostatics.member_stress import compute_member_stresses, find_given_factors

        return compute_member_stresses(find_given_factors(kind, values), loads, cuts.strength)
    return compute_stresses(MODULI[kind](values), loads, cuts.strength)


def find_moment_arm(cuts: Cuts) -> float:
    """Return a length [m] that compares moments with forces: of the series of cuts; of a single one how far the mass
    beyond it reaches from the body's origin, or, without such mass, how far the body reaches.
    """
    points = cuts.points.reshape(-1, 3)
    length = float(np.abs(points - points.mean(axis=0)).max())
    mass = float(cuts.pieces[..., 3, 3].max())
    if length == 0.0 and mass > 0.0:
        length = float(np.sqrt(np.abs(cuts.pieces[..., :3, :3]).max() / mass))
    return length or cuts.plane_tolerance / tolerances.IN_PLANE


def find_reduction_line(cut_places: CutPlaces, force: Array, moment: Array) -> Block:
    """Find the points of the plane where force and moment in it are parallel: Q.p = -n.(Q x M_t)/N, direction n x Q.

    moment is about the cut's own point. point: the one nearest to that; pressure_centre: where the moment in the plane
    is zero. nan where N = 0 (no such points, or all) or Q = 0 (all points); `kind` says which: 0 a line, 1 none, 2 all.
    manual/theory.md, "Reduction line".
    """
    cuts, cut_points, to_world_axes = cut_places.cuts, cut_places.cut_points, cut_places.to_world_axes
    n = cuts.n[:, None, None]
    N, T = compute_axis_component(cuts.n, force), compute_axis_component(cuts.n, moment)
    Q, M_t = force - n * N, moment - n * T
    reach = find_moment_arm(cuts)
    size = np.sqrt(np.sum(force**2, axis=0)) + np.sqrt(np.sum(moment**2, axis=0)) / reach
    q = np.sqrt(np.sum(Q**2, axis=0))
    no_N, no_Q = np.abs(N) <= tolerances.NO_FORCE * size, q <= tolerances.NO_FORCE * size
    twist = compute_axis_component(cuts.n, cross_first_axis(Q, M_t))
    free_N = np.where(no_N, np.nan, N)
    free_Q = np.where(no_Q | no_N, np.nan, q)
    n = np.broadcast_to(n, Q.shape)
    point = cut_points - twist / (free_N * free_Q**2) * Q
    direction = cross_first_axis(n, Q) / free_Q
    pressure = cut_points + cross_first_axis(n, M_t) / free_N
    parallel = np.abs(twist) <= tolerances.NO_FORCE * size * size * reach
    kind = np.where(no_N, np.where(parallel, 2.0, 1.0), np.where(no_Q, 2.0, 0.0))
    return {
        "point": to_world_axes(point, is_position=True), "direction": to_world_axes(direction),
        "pressure_centre": to_world_axes(pressure, is_position=True), "kind": kind,
    }  # fmt: skip
