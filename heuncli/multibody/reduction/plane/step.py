"""Find the plane in which a scene stays: it moves as the flat scene in that plane does
(multibody/reduction/plane/mechanism.py).

Either the joints leave bodies only rotations about the normal and shifts across it, or bodies that could leave the
plane do not, because the scene is its own mirror image in it (multibody/reduction/plane/departures.py).
"""

from __future__ import annotations

from itertools import islice

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.plane.departures import iter_departures
from heuncli.multibody.reduction.plane.mechanism import UnrepresentableLoadError, make_flat_scene
from heuncli.multibody.reduction.plane.plane_states import PlaneStateMap
from heuncli.multibody.reduction.plane.view import Departure, PlaneView, find_neighbours, iter_normals, make_view
from heuncli.multibody.tree.prepare import PreparedScene

MAX_LISTED = 3  # departures from a plane: a scene with more large ones is not expected to be flat


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """Return the flat scene, or sentences on what keeps it from being flat where that is little; nothing for a scene in
    space.
    """
    nearest: tuple[PlaneView, list[Departure]] | None = None
    joint_neighbours = find_neighbours(scene)
    for n in iter_normals(scene):
        plane_view = make_view(scene, n, joint_neighbours)
        leaving = list(islice(iter_departures(plane_view), MAX_LISTED + 1))
        if not leaving:
            return _make_reduction(plane_view)
        if nearest is None or _severity(nearest[1]) > _severity(leaving):
            nearest = plane_view, leaving
    if nearest is None:
        return ()
    plane_view, leaving = nearest
    leaving = leaving if _is_nearly_flat(leaving) else _coupling_departures(plane_view)
    if not leaving:
        return ()
    what = "; ".join(departure.what for departure in leaving[:MAX_LISTED])
    more = " and more" if len(leaving) > MAX_LISTED else ""
    return (f"not solved in the plane normal to {_format_normal(plane_view)}: {what}{more}",)


def _severity(leaving: list[Departure]) -> tuple[int, float]:
    return len(leaving), max(departure.size for departure in leaving)


def _is_nearly_flat(leaving: list[Departure]) -> bool:
    """Whether a reader might expect the scene to be flat: one load or drive leaves the plane, or all departures are
    small.
    """
    return (len(leaving) == 1 and leaving[0].acts) or all(
        departure.size < tolerances.NEARLY_FLAT for departure in leaving
    )


def _coupling_departures(plane_view: PlaneView) -> list[Departure]:
    """Return the coordinates out of the plane that couplings contain, if all joints are along the normal or across
    it.
    """
    if not plane_view.scene.mechanism.couplings or any(
        stance.misalignment > tolerances.FLAT for stance in plane_view.orientations
    ):
        return []
    from heuncli.multibody.reduction.plane.flat_couplings import iter_coupling_departures  # few scenes have them

    return list(iter_coupling_departures(plane_view, None))


def _make_reduction(plane_view: PlaneView) -> Reduction | tuple[str, ...]:
    try:
        flat = make_flat_scene(plane_view)
    except UnrepresentableLoadError as missing:
        return (f"not solved in the plane normal to {_format_normal(plane_view)}: {missing}",)
    states = PlaneStateMap(plane_view, flat)
    where = f"solved in the plane normal to {_format_normal(plane_view)}: "
    if all(plane_view.upright):
        reason = "the joints allow only rotations about that direction and displacements perpendicular to it"
        return Reduction(flat, states.embed, states.restrict, (where + reason,))
    reason = "model and motion are symmetric about this plane; stability out of the plane is not considered"
    hidden = "stability of the planar motion against out-of-plane disturbances: the solved model cannot leave the plane"
    return Reduction(flat, states.embed, states.restrict, (where + reason,), (hidden,))


def _format_normal(plane_view: PlaneView) -> str:
    """Format the normal."""
    n = plane_view.n
    for k, name in enumerate("xyz"):
        if np.count_nonzero(n) == 1 and n[k] != 0.0:
            return name
    return "({})".format(", ".join(f"{0.0 if abs(x) <= tolerances.FLAT else x:.6g}" for x in n))
