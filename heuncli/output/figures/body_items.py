"""Draw the bodies of a machine from the farthest to the nearest, with point masses and centres of mass.

Of instants later than the first (k > 0) they are thin, pale lines.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Item, Link, Polygon, Strokes, Symbol
from heuncli.output.drawing.style import ARM_WIDTH, DASH_DOT, LINK_WIDTH, OUTLINE_WIDTH, RIM_WIDTH, THIN_WIDTH
from heuncli.output.figures.posed_machine import PosedMachine, compute_area, to_pair
from heuncli.output.machine_geometry.machine import BodyGeometry
from heuncli.output.machine_geometry.silhouettes import SolidEdges, find_silhouette, select_visible_edges
from heuncli.output.machine_geometry.solids import compute_convex_hull
from heuncli.scene.file_format.names import GROUND

MAX_CENTRES = 40  # bodies; with more of them no centres of mass are marked
SAME_DEPTH = 1e-6  # share of the figure's depth: closer pieces are equally far


class DrawnPiece(NamedTuple):
    """A part of a body with its items; depth and area decide the order of drawing."""

    depth: float
    area: float
    items: tuple[Item, ...]


def draw_bodies(posed_machine: PosedMachine, k: int) -> list[Item]:
    """Draw the bodies at instant k, far ones first; of equally far ones the large ones first."""
    pieces = [piece for body in posed_machine.machine.bodies for piece in _draw_pieces(posed_machine, body, k)]
    depths = [piece.depth for piece in pieces if piece.depth > -np.inf]
    step = SAME_DEPTH * (max(depths) - min(depths)) if depths else 0.0

    def order(piece: DrawnPiece) -> tuple[float, float]:
        level = piece.depth if step == 0.0 or piece.depth == -np.inf else round(piece.depth / step)
        return float(level), -piece.area

    pieces.sort(key=order)
    circles = [] if k > 0 else _draw_pitch_circles(posed_machine, k)
    paths = (posed_machine.project(GROUND, path, k) for path in posed_machine.machine.paths if k == 0)
    path_strokes: list[Item] = [Strokes(np.stack([ends[:-1], ends[1:]], axis=1), None, OUTLINE_WIDTH) for ends in paths]
    return [*path_strokes, *(item for piece in pieces for item in piece.items), *circles]


def _draw_pieces(posed_machine: PosedMachine, body: BodyGeometry, k: int) -> Iterator[DrawnPiece]:
    """Yield the solids of a body, or the lines between its points."""
    pen = posed_machine.pens[body.name]
    for solid in posed_machine.solids[body.name]:
        places = posed_machine.poses.locate_points(body.name, solid.surface.corners, k)
        contour = compute_convex_hull(posed_machine.size * posed_machine.view.project(places))
        if not solid.surface.convex:
            yield _draw_mesh(posed_machine, body, solid, k)
            continue
        depth, is_large = float(posed_machine.view.compute_depth(places).mean()), posed_machine.is_large(contour)
        lines: tuple[Item, ...] = ()
        if k == 0:
            edges = select_visible_edges(solid, posed_machine.poses.orientations[body.name][k], posed_machine.view)
            lines = (Strokes(posed_machine.project(body.name, edges, k), pen, OUTLINE_WIDTH, is_ghost=is_large),)
        width = OUTLINE_WIDTH if k > 0 or is_large else RIM_WIDTH
        shape = Polygon(body.name, contour, pen, is_opaque=k == 0, width=width, is_ghost=k > 0, is_light=is_large)
        yield DrawnPiece(-np.inf if is_large else depth, compute_area(contour), (shape, *lines))
    middle = max((posed_machine.find_depth(body.name, own.corners, k) for own in body.surfaces), default=-np.inf)
    is_link = not (body.surfaces or body.lines or body.pitch_circles)
    for number, line in enumerate((*body.bars, *body.lines)):
        if len(line) > 1:
            depth = posed_machine.find_depth(body.name, line, k)
            if number >= len(body.bars) and depth < middle - SAME_DEPTH * posed_machine.extent.max():
                continue  # on the far side of the body
            ends = posed_machine.project(body.name, line, k)
            item: Item = Link(*to_pair(ends[0]), *to_pair(ends[-1]), "bar", pen, body.name)
            if k > 0 or not is_link:
                width = (
                    RIM_WIDTH
                    if number >= len(body.bars)
                    else ARM_WIDTH
                    if posed_machine.solids[body.name]
                    else LINK_WIDTH
                )
                item = Strokes(
                    np.stack([ends[:-1], ends[1:]], axis=1), pen, OUTLINE_WIDTH if k > 0 else width, is_ghost=k > 0
                )
            yield DrawnPiece(depth, 0.0, (item,))


def _draw_pitch_circles(posed_machine: PosedMachine, k: int) -> Iterator[Strokes | Symbol]:
    """Draw the pitch circles of gears, over the bodies, and the points at which they mesh."""
    for body in posed_machine.machine.bodies:
        for circle in body.pitch_circles:
            ends = posed_machine.project(body.name, circle, k)
            yield Strokes(np.stack([ends[:-1], ends[1:]], axis=1), posed_machine.pens[body.name], THIN_WIDTH, DASH_DOT)
    for mesh in posed_machine.machine.pitch_points:
        place = to_pair(posed_machine.project(mesh.carrier, mesh.point, k))
        yield Symbol(*place, "pitch point", (1.0, 0.0), None, f"{mesh.name}: pitch point")


def _draw_mesh(posed_machine: PosedMachine, body: BodyGeometry, solid: SolidEdges, k: int) -> DrawnPiece:
    """Draw a body of any form: its silhouette, with see-through holes, and its edges on the near side."""
    pen = posed_machine.pens[body.name]
    R = posed_machine.poses.orientations[body.name][k]
    flat = posed_machine.project(body.name, solid.surface.corners, k)
    lines = [flat[line] for line in find_silhouette(solid, R, posed_machine.view)]
    contour = np.concatenate([np.concatenate([line, line[:1]]) for line in lines] or [flat[:0]])
    return_path = [line[:1] for line in lines[-2::-1]]  # the path between the lines and back has no width
    rims = [np.stack([line, np.roll(line, -1, axis=0)], axis=1) for line in lines]
    items: list[Item] = [
        Polygon(body.name, np.concatenate([contour, *return_path]), pen, is_opaque=k == 0, has_outline=False)
    ]
    items.append(
        Strokes(
            np.concatenate([flat[:0].reshape(0, 2, 2), *rims]),
            pen,
            OUTLINE_WIDTH if k > 0 else RIM_WIDTH,
            is_ghost=k > 0,
        )
    )
    if k == 0:
        items.append(
            Strokes(
                posed_machine.project(body.name, select_visible_edges(solid, R, posed_machine.view), k),
                pen,
                OUTLINE_WIDTH,
            )
        )
    depth = float(
        posed_machine.view.compute_depth(posed_machine.poses.locate_points(body.name, solid.surface.corners, k)).mean()
    )
    return DrawnPiece(depth, sum(abs(compute_area(posed_machine.size * line)) for line in lines), tuple(items))


def draw_mass_marks(posed_machine: PosedMachine, k: int) -> Iterator[Symbol]:
    """Draw point masses and centres of mass."""
    shows_centres = len(posed_machine.machine.bodies) <= MAX_CENTRES
    for body in posed_machine.machine.bodies:
        pen, centre = posed_machine.pens[body.name], posed_machine.centers[body.name]
        masses = posed_machine.masses[body.name]
        for place in masses:
            position = to_pair(posed_machine.project(body.name, place, k))
            yield Symbol(*position, "mass", (1.0, 0.0), pen, f"{body.name}: point mass")
        tolerance = tolerances.ONE_PLACE * float(np.abs(centre).max())
        if shows_centres and not any(np.abs(place - centre).max() <= tolerance for place in masses):
            position = to_pair(posed_machine.project(body.name, centre, k))
            yield Symbol(*position, "centre", (1.0, 0.0), pen, f"{body.name}: centre of mass")
