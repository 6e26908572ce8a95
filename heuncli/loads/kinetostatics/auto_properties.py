"""Find section properties from the shapes that are cut (`properties: auto`).

One shape that is cut square: its circle, ring or rectangle. Concentric circles and rings that touch: the ring that they
make. Rectangles with sides along e1 and e2 that touch and make one section, as flanges and web do, are combined by
sums, by Steiner, if they are the same turned by 180 degrees, so that their shear centre is their centroid:

    A = sum A_i,   I1 = sum (h_i^2/12 + y_i^2) A_i,   I2 likewise,   I12 = sum x_i y_i A_i = 0: e1, e2 are principal
    J >= sum J_i: joined parts twist no more than separate ones (their stress functions together are one of the whole)

so that stresses from torsion are on the safe side; so are those from shear, for a shape that is not known. For a mesh
the outline gives them (scene/shapes/figures.py), J again from below.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.member_stress import (
    UPRIGHT,
    Frame,
    MemberFactors,
    compute_member_stresses,
    make_factors,
)
from heuncli.loads.kinetostatics.stress import MODULI, compute_stresses, compute_torsion_constant
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.composite_solid import CompositeSolid
from heuncli.scene.shapes.figures import (
    CuttingPlanes,
    Figure,
    MemberFigure,
    ProfileFigure,
    RectangleFigure,
    RoundFigure,
    UnknownFigure,
    find_figure,
)

SectionValues = Mapping[str, float]


@record
class CutGroup:
    """Cuts of one kind: which ones, (k,), and their properties, numbers or arrays over all cuts.

    member, frame: of a member, its factors and its axes instead
    """

    cut_mask: Mask
    kind: str
    values: Mapping[str, float | Array]
    member: MemberFactors | None = None
    frame: Frame = UPRIGHT


@record
class CutProperties:
    """The properties of cuts, and for the others, by their numbers, why they are not known."""

    groups: tuple[CutGroup, ...]
    missing: Mapping[int, str]


@record
class CutForm:
    """A form and the planes that cut it: n, e1, heights d (k,), side (k,) as in loads/kinetostatics/cuts.py."""

    form: CompositeSolid
    n: Array
    e1: Array
    d: Array
    side: Array


def find_cut_properties(cut: CutForm) -> CutProperties:
    """Find the properties of each cut; at a shoulder where nothing decides between its two sides, those of the smaller
    one.
    """
    before, after = (find_one_sided(cut, -1.0), find_one_sided(cut, 1.0))
    takes_before = cut.side > 0.0
    is_undecided = cut.side == 0.0
    area_before, area_after = find_areas(before, len(cut.d)), find_areas(after, len(cut.d))
    takes_before = takes_before | (is_undecided & np.isfinite(area_before) & ~(area_after < area_before))
    groups = [
        replace(group, cut_mask=group.cut_mask & is_chosen)
        for properties, is_chosen in ((before, takes_before), (after, ~takes_before))
        for group in properties.groups
        if (group.cut_mask & is_chosen).any()
    ]
    missing = {k: why for k, why in before.missing.items() if takes_before[k]}
    return CutProperties(tuple(groups), missing | {k: why for k, why in after.missing.items() if not takes_before[k]})


def find_areas(properties: CutProperties, count: int) -> Array:
    """Return the areas of the cuts; nan where they are not known."""
    area = np.full(count, np.nan)
    for group in properties.groups:
        if group.member is not None:
            area[group.cut_mask] = group.member.section.area
            continue
        values = {name: np.broadcast_to(value, count)[group.cut_mask] for name, value in group.values.items()}
        area[group.cut_mask] = AREAS[group.kind](values)
    return area


AREAS: dict[str, Callable[[Mapping[str, Array]], Array]] = {
    "circle": lambda v: np.pi * v["radius"] ** 2,
    "tube": lambda v: np.pi * (v["radius"] ** 2 - v["inner_radius"] ** 2),
    "rectangle": lambda v: v["width"] * v["height"],
    "general": lambda v: v["area"],
}


def find_one_sided(cut: CutForm, side: float) -> CutProperties:
    """Find the properties as limits from before (-1) or beyond (1) the planes."""
    cutting_planes = CuttingPlanes(cut.n, cut.e1, cut.d, cut.d + side * cut.form.tolerance)
    figures = [figure for part in cut.form.parts if (figure := find_figure(part, cutting_planes)) is not None]
    is_met = np.array([figure.is_met for figure in figures], dtype=bool).reshape(len(figures), len(cut.d))
    count = is_met.sum(axis=0)
    groups: list[CutGroup] = []
    missing = {int(k): "the cut meets no shape with a thickness" for k in np.flatnonzero(count == 0)}
    for figure, is_own in zip(figures, is_met, strict=True):
        is_alone = is_own & (count == 1)
        if isinstance(figure, UnknownFigure):
            missing |= {int(k): figure.reason for k in np.flatnonzero(is_alone)}
            continue
        if isinstance(figure, ProfileFigure):
            missing |= {int(k): figure.missing[int(k)] for k in np.flatnonzero(is_alone) if int(k) in figure.missing}
            is_alone = is_alone & ~np.isin(np.arange(len(cut.d)), [*figure.missing])
        if isinstance(figure, RoundFigure):
            missing |= {
                int(k): "the cut has no area" for k in np.flatnonzero(is_alone & ~(figure.outer > figure.inner))
            }
            is_alone = is_alone & (figure.outer > figure.inner)
        groups += [group for group in make_groups(figure, is_alone) if group.cut_mask.any()]
    combined_groups: dict[tuple[str, tuple[tuple[str, float], ...]], list[int]] = {}
    for k in np.flatnonzero(count > 1).tolist():
        combination = combine_figures(
            [figure for figure, is_own in zip(figures, is_met, strict=True) if is_own[k]], k, cut
        )
        if isinstance(combination, str):
            missing[k] = combination
        else:
            combined_groups.setdefault((combination[0], tuple(combination[1].items())), []).append(k)
    for (kind, values), cuts in combined_groups.items():
        groups.append(CutGroup(np.isin(np.arange(len(cut.d)), cuts), kind, dict(values)))
    return CutProperties(tuple(groups), missing)


def make_groups(figure: RoundFigure | RectangleFigure | MemberFigure | ProfileFigure, cut_mask: Mask) -> list[CutGroup]:
    """Make the groups of cuts through one shape alone."""
    if isinstance(figure, MemberFigure):
        return make_member_groups(figure, cut_mask)
    if isinstance(figure, ProfileFigure):
        return [CutGroup(cut_mask, "general", figure.values)]
    if isinstance(figure, RectangleFigure):
        return [CutGroup(cut_mask, "rectangle", {"width": figure.width, "height": figure.height})]
    is_solid = figure.inner <= 0.0
    ring = {"radius": figure.outer, "inner_radius": figure.inner}
    return [
        CutGroup(cut_mask & is_solid, "circle", {"radius": figure.outer}),
        CutGroup(cut_mask & ~is_solid, "tube", ring),
    ]


def make_member_groups(figure: MemberFigure, cut_mask: Mask) -> list[CutGroup]:
    """Make the groups of cuts through a member: those of equal measures together."""
    a, b, c, d = (np.round(figure.frame, 12) + 0.0).ravel().tolist()
    groups: dict[MemberFactors, list[int]] = {}
    for k in np.flatnonzero(cut_mask).tolist():
        groups.setdefault(make_factors(figure.family, figure.measures[k]), []).append(k)
    planes = np.arange(len(cut_mask))
    return [
        CutGroup(np.isin(planes, cuts), figure.family, {}, factors, (a, b, c, d)) for factors, cuts in groups.items()
    ]


def combine_figures(figures: Sequence[Figure], k: int, cut: CutForm) -> tuple[str, SectionValues] | str:
    """Return kind and properties of a cut through several shapes, or why they are not known."""
    unknown = next((figure.reason for figure in figures if isinstance(figure, UnknownFigure)), None)
    if unknown is not None:
        return unknown
    if any(isinstance(figure, MemberFigure) for figure in figures):
        return "the cut meets a member and other shapes, and heun cannot tell whether they touch"
    if any(isinstance(figure, ProfileFigure) for figure in figures):
        return "the cut meets a mesh and other shapes, and heun cannot tell whether they touch"
    tolerance = tolerances.TOUCHING * cut.form.tolerance
    rounds = [figure for figure in figures if isinstance(figure, RoundFigure)]
    rectangles = [figure for figure in figures if isinstance(figure, RectangleFigure)]
    if len(rounds) == len(figures):
        return combine_rings(rounds, k, tolerance)
    if len(rectangles) == len(figures):
        return combine_rectangles(rectangles, k, cut, tolerance)
    return "the cut meets round and rectangular shapes"


def combine_rings(rounds: Sequence[RoundFigure], k: int, tolerance: float) -> tuple[str, SectionValues] | str:
    """Combine concentric circles and rings, each as wide as the hole of the next."""
    centers = np.array([figure.center[k] for figure in rounds])
    if np.sqrt(np.sum((centers - centers[0]) ** 2, axis=1)).max() > tolerance:
        return "the cut round shapes are not concentric"
    radii = sorted((float(figure.inner[k]), float(figure.outer[k])) for figure in rounds)
    for (_, outer), (inner, _) in pairwise(radii):
        if inner < outer - tolerance:
            return "the cut shapes overlap"
        if inner > outer + tolerance:
            return "the cut shapes do not touch"
    inner, outer = radii[0][0], radii[-1][1]
    return ("circle", {"radius": outer}) if inner <= 0.0 else ("tube", {"radius": outer, "inner_radius": inner})


def combine_rectangles(
    rectangles: Sequence[RectangleFigure], k: int, cut: CutForm, tolerance: float
) -> tuple[str, SectionValues] | str:
    """Combine rectangles that touch, but do not overlap, into one section."""
    e = np.stack([cut.e1, np.cross(cut.n, cut.e1)])
    middle = np.array([e @ figure.center[k] for figure in rectangles])
    size = np.array([[figure.width, figure.height] for figure in rectangles])
    gap = np.abs(middle[:, None] - middle) - 0.5 * (size[:, None] + size)  # along e1 and e2, < 0 where they overlap
    others = ~np.eye(len(size), dtype=bool)
    if (others & (gap < -tolerance).all(axis=2)).any():
        return "the cut shapes overlap"
    # they touch along a side: at a mere corner they would not hold together
    is_touching = (gap <= tolerance).all(axis=2) & (gap < -tolerance).any(axis=2)
    is_linked = np.linalg.matrix_power((is_touching | ~others).astype(float), len(size)) > 0.0
    if not is_linked.all():
        return "the cut shapes do not touch"
    A = size.prod(axis=1)
    area = float(A.sum())
    offsets = middle - (A @ middle) / area
    I2, I1 = (float(A @ (size[:, i] ** 2 / 12.0 + offsets[:, i] ** 2)) for i in (0, 1))
    product_moment = float(A @ (offsets[:, 0] * offsets[:, 1]))
    if abs(product_moment) > tolerances.PRINCIPAL * np.sqrt(I1 * I2):
        return "e1 and e2 are not principal axes of the combined cut shapes"
    if not is_point_symmetric(offsets, size, tolerance):
        return "shear forces twist the combined cut shapes, because they lack 180-degree rotational symmetry"
    c1, c2 = (np.abs(offsets) + 0.5 * size).max(axis=0).tolist()
    J = sum(compute_torsion_constant(*one) for one in size.tolist())
    return "general", {"area": area, "I1": I1, "I2": I2, "J": J, "c1": c1, "c2": c2}


def is_point_symmetric(offsets: Array, size: Array, tolerance: float) -> bool:
    """Return whether rectangles about their centroid are the same turned by 180 degrees: it is the shear centre
    then.
    """
    same_place = np.abs(offsets[:, None] + offsets).max(axis=2) <= tolerance
    same = np.asarray(same_place & (np.abs(size[:, None] - size).max(axis=2) <= tolerance))
    return bool(same.any(axis=1).all())


def make_stress_block(
    properties: CutProperties, cuts: tuple[int, ...], loads: Mapping[str, Array], strength: float | None
) -> Block:
    """Return the stresses of cuts, (n_t, k), nan where properties are not known; cuts: (k,) or (n_t, k)."""
    shape = loads["N"].shape
    block: Block = {}
    for group in properties.groups:
        group_mask = np.broadcast_to(group.cut_mask.reshape(cuts), shape)
        values: dict[str, float | Array] = {
            name: np.broadcast_to(value.reshape(cuts), shape)[group_mask] if isinstance(value, np.ndarray) else value
            for name, value in group.values.items()
        }
        group_loads = {name: load[group_mask] for name, load in loads.items()}
        group_stresses = (
            compute_stresses(MODULI[group.kind](values), group_loads, strength)
            if group.member is None
            else compute_member_stresses(group.member, group_loads, strength, group.frame)
        )
        fill_block(block, group_stresses, group_mask)
    return block


def fill_block(block: Block, values: Block, mask: Mask) -> None:
    """Fill in the numbers of some cuts; in others a number that they alone have is nan."""
    for name, value in values.items():
        if isinstance(value, dict):
            fill_block(block.setdefault(name, {}), value, mask)
        else:
            block.setdefault(name, np.full(mask.shape, np.nan))[mask] = value
