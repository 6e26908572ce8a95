"""Properties of sections taken from the shapes that are cut (`properties: auto`).

One shape that is cut square: its circle, ring or rectangle. Circles and rings about one centre that touch: the ring
that they make. Rectangles with sides along e1 and e2 that touch and make one section, as flanges and web do, are given
by their sums, by Steiner, if they are the same turned by 180 degrees, so that their shear centre is their centroid:

    A = sum A_i,   I1 = sum (h_i^2/12 + y_i^2) A_i,   I2 likewise,   I12 = sum x_i y_i A_i = 0: e1, e2 are principal
    J >= sum J_i: joined parts twist no more than apart (their stress functions together are one of the whole)

so that stresses from torsion are on the safe side; so are those from shear, of a shape that is not known. Of a mesh the
outline has them (scene/shapes/profiles.py), J again from below.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.loads.kinetostatics.stress import MODULI, stresses, torsion_constant
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.figure_kinds import CuttingPlanes, Figure, Profile, Rectangle, Round, Unknown
from heuncli.scene.shapes.figures import figure_of
from heuncli.scene.shapes.forms import Form

Values = Mapping[str, float]


@record
class CutGroup:
    """Cuts of one kind: which they are, (k,), and their properties, numbers or arrays over all cuts."""

    on: Mask
    kind: str
    values: Mapping[str, float | Array]


@record
class CutProperties:
    """The properties of cuts, and why those of the others are not known: by the number of the cut."""

    groups: tuple[CutGroup, ...]
    missing: Mapping[int, str]


@record
class Cutting:
    """A form and the planes that cut it: n, e1, heights d (k,), side (k,) as loads/kinetostatics/cuts.py has it."""

    form: Form
    n: Array
    e1: Array
    d: Array
    side: Array


def properties_of(cut: Cutting) -> CutProperties:
    """The properties of each cut; where nothing decides between the two sides of a shoulder those of the smaller."""
    before, beyond = (one_sided(cut, -1.0), one_sided(cut, 1.0))
    first = cut.side > 0.0
    both = cut.side == 0.0
    area_before, area_beyond = areas(before, len(cut.d)), areas(beyond, len(cut.d))
    first = first | (both & np.isfinite(area_before) & ~(area_beyond < area_before))
    groups = [
        CutGroup(group.on & own, group.kind, group.values)
        for found, own in ((before, first), (beyond, ~first))
        for group in found.groups
        if (group.on & own).any()
    ]
    missing = {k: why for k, why in before.missing.items() if first[k]}
    return CutProperties(tuple(groups), missing | {k: why for k, why in beyond.missing.items() if not first[k]})


def areas(found: CutProperties, count: int) -> Array:
    """The areas of the cuts; nan where they are not known."""
    area = np.full(count, np.nan)
    for group in found.groups:
        values = {name: np.broadcast_to(value, count)[group.on] for name, value in group.values.items()}
        area[group.on] = AREAS[group.kind](values)
    return area


AREAS: dict[str, Callable[[Mapping[str, Array]], Array]] = {
    "circle": lambda v: np.pi * v["radius"] ** 2,
    "tube": lambda v: np.pi * (v["radius"] ** 2 - v["inner_radius"] ** 2),
    "rectangle": lambda v: v["width"] * v["height"],
    "general": lambda v: v["area"],
}


def one_sided(cut: Cutting, side: float) -> CutProperties:
    """The properties as limits from before (-1) or beyond (1) the planes."""
    at = CuttingPlanes(cut.n, cut.e1, cut.d, cut.d + side * cut.form.near)
    found = [figure for part in cut.form.parts if (figure := figure_of(part, at)) is not None]
    met = np.array([figure.met for figure in found], dtype=bool).reshape(len(found), len(cut.d))
    count = met.sum(axis=0)
    groups: list[CutGroup] = []
    missing = {int(k): "no shape with a thickness is cut" for k in np.flatnonzero(count == 0)}
    for figure, own in zip(found, met, strict=True):
        alone = own & (count == 1)
        if isinstance(figure, Unknown):
            missing |= {int(k): figure.why for k in np.flatnonzero(alone)}
            continue
        if isinstance(figure, Profile):
            missing |= {int(k): figure.missing[int(k)] for k in np.flatnonzero(alone) if int(k) in figure.missing}
            alone = alone & ~np.isin(np.arange(len(cut.d)), [*figure.missing])
        if isinstance(figure, Round):
            missing |= {int(k): "the cut has no area" for k in np.flatnonzero(alone & ~(figure.outer > figure.inner))}
            alone = alone & (figure.outer > figure.inner)
        groups += [group for group in groups_of(figure, alone) if group.on.any()]
    several: dict[tuple[str, tuple[tuple[str, float], ...]], list[int]] = {}
    for k in np.flatnonzero(count > 1).tolist():
        together = combined([figure for figure, own in zip(found, met, strict=True) if own[k]], k, cut)
        if isinstance(together, str):
            missing[k] = together
        else:
            several.setdefault((together[0], tuple(together[1].items())), []).append(k)
    for (kind, values), cuts in several.items():
        groups.append(CutGroup(np.isin(np.arange(len(cut.d)), cuts), kind, dict(values)))
    return CutProperties(tuple(groups), missing)


def groups_of(figure: Round | Rectangle | Profile, on: Mask) -> list[CutGroup]:
    """Cuts through one shape alone."""
    if isinstance(figure, Profile):
        return [CutGroup(on, "general", figure.values)]
    if isinstance(figure, Rectangle):
        return [CutGroup(on, "rectangle", {"width": figure.width, "height": figure.height})]
    full = figure.inner <= 0.0
    ring = {"radius": figure.outer, "inner_radius": figure.inner}
    return [CutGroup(on & full, "circle", {"radius": figure.outer}), CutGroup(on & ~full, "tube", ring)]


def combined(figures: Sequence[Figure], k: int, cut: Cutting) -> tuple[str, Values] | str:
    """Kind and properties of a cut through several shapes, or why they are not known."""
    unknown = next((figure.why for figure in figures if isinstance(figure, Unknown)), None)
    if unknown is not None:
        return unknown
    if any(isinstance(figure, Profile) for figure in figures):
        return "a mesh is cut together with other shapes, and whether they touch is not known"
    near = tolerances.TOUCHING * cut.form.near
    rounds = [figure for figure in figures if isinstance(figure, Round)]
    rectangles = [figure for figure in figures if isinstance(figure, Rectangle)]
    if len(rounds) == len(figures):
        return nested(rounds, k, near)
    if len(rectangles) == len(figures):
        return joined(rectangles, k, cut, near)
    return "round and rectangular shapes are cut together"


def nested(rounds: Sequence[Round], k: int, near: float) -> tuple[str, Values] | str:
    """Circles and rings about one centre, each as wide as the hole of the next."""
    centers = np.array([figure.center[k] for figure in rounds])
    if np.sqrt(np.sum((centers - centers[0]) ** 2, axis=1)).max() > near:
        return "round shapes are cut that have not one centre"
    radii = sorted((float(figure.inner[k]), float(figure.outer[k])) for figure in rounds)
    for (_, outer), (inner, _) in pairwise(radii):
        if inner < outer - near:
            return "the shapes that are cut overlap"
        if inner > outer + near:
            return "the shapes that are cut do not touch"
    inner, outer = radii[0][0], radii[-1][1]
    return ("circle", {"radius": outer}) if inner <= 0.0 else ("tube", {"radius": outer, "inner_radius": inner})


def joined(rectangles: Sequence[Rectangle], k: int, cut: Cutting, near: float) -> tuple[str, Values] | str:
    """Rectangles that touch, but do not overlap, as one section."""
    e = np.stack([cut.e1, np.cross(cut.n, cut.e1)])
    middle = np.array([e @ figure.center[k] for figure in rectangles])
    size = np.array([[figure.width, figure.height] for figure in rectangles])
    gap = np.abs(middle[:, None] - middle) - 0.5 * (size[:, None] + size)  # along e1 and e2, < 0 where they overlap
    others = ~np.eye(len(size), dtype=bool)
    if (others & (gap < -near).all(axis=2)).any():
        return "the shapes that are cut overlap"
    # they touch along a side: at a mere corner they would not hold together
    touching = (gap <= near).all(axis=2) & (gap < -near).any(axis=2)
    linked = np.linalg.matrix_power((touching | ~others).astype(float), len(size)) > 0.0
    if not linked.all():
        return "the shapes that are cut do not touch"
    A = size.prod(axis=1)
    area = float(A.sum())
    off = middle - (A @ middle) / area
    I2, I1 = (float(A @ (size[:, i] ** 2 / 12.0 + off[:, i] ** 2)) for i in (0, 1))
    mixed = float(A @ (off[:, 0] * off[:, 1]))
    if abs(mixed) > tolerances.PRINCIPAL * np.sqrt(I1 * I2):
        return "e1 and e2 are not the principal axes of the shapes that are cut together"
    if not is_point_symmetric(off, size, near):
        return "shear forces twist the shapes that are cut together, which are not the same turned by 180 degrees"
    c1, c2 = (np.abs(off) + 0.5 * size).max(axis=0).tolist()
    J = sum(torsion_constant(*one) for one in size.tolist())
    return "general", {"area": area, "I1": I1, "I2": I2, "J": J, "c1": c1, "c2": c2}


def is_point_symmetric(off: Array, size: Array, near: float) -> bool:
    """Whether rectangles about their common centroid are the same turned by 180 degrees: it is the shear centre."""
    place = np.abs(off[:, None] + off).max(axis=2) <= near
    same = np.asarray(place & (np.abs(size[:, None] - size).max(axis=2) <= near))
    return bool(same.any(axis=1).all())


def stress_block(
    found: CutProperties, cuts: tuple[int, ...], loads: Mapping[str, Array], strength: float | None
) -> Block:
    """The stresses of cuts by their groups, (n_t, k), nan where properties are not known; cuts: (k,) or (n_t, k)."""
    shape = loads["N"].shape
    block: Block = {}
    for group in found.groups:
        on = np.broadcast_to(group.on.reshape(cuts), shape)
        values: dict[str, float | Array] = {
            name: np.broadcast_to(value.reshape(cuts), shape)[on] if isinstance(value, np.ndarray) else value
            for name, value in group.values.items()
        }
        own = stresses(MODULI[group.kind](values), {name: load[on] for name, load in loads.items()}, strength)
        for name, stress in own.items():
            block.setdefault(name, np.full(shape, np.nan))[on] = stress
    return block
