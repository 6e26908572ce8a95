"""The plane that a scene stays in: it moves as the flat scene in that plane does
(multibody/reduction/plane/mechanism.py).

Either no joint leaves a body another motion than turns about the normal and shifts across it, or what could leave the
plane does not, for the scene is its own mirror image in it (multibody/reduction/plane/departures.py).
"""

from __future__ import annotations

from itertools import islice

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.reduction.model import Reduction
from heuncli.multibody.reduction.plane.departure import Departure
from heuncli.multibody.reduction.plane.departures import departures
from heuncli.multibody.reduction.plane.frame import candidates
from heuncli.multibody.reduction.plane.mechanism import NotTold, flat_scene
from heuncli.multibody.reduction.plane.states import States
from heuncli.multibody.reduction.plane.view import View, neighbours, view
from heuncli.multibody.tree.prepare import PreparedScene

MOST_TOLD = 3  # what leaves a plane: of a scene that more leaves by much nobody expects that it is flat


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """The flat scene; what keeps it from being flat, where that is little; nothing of a scene in space."""
    nearest: tuple[View, list[Departure]] | None = None
    near = neighbours(scene)
    for n in candidates(scene):
        seen = view(scene, n, near)
        found = list(islice(departures(seen), MOST_TOLD + 1))
        if not found:
            return _reduction(seen)
        if nearest is None or _worse(nearest[1]) > _worse(found):
            nearest = seen, found
    if nearest is None:
        return ()
    seen, found = nearest
    found = found if _nearly(found) else _of_couplings(seen)
    if not found:
        return ()
    what = "; ".join(departure.what for departure in found[:MOST_TOLD])
    more = " and more" if len(found) > MOST_TOLD else ""
    return (f"not solved in the plane across {_direction(seen)}: {what}{more}",)


def _worse(found: list[Departure]) -> tuple[int, float]:
    return len(found), max(departure.size for departure in found)


def _nearly(found: list[Departure]) -> bool:
    """Whether a reader might expect that a scene is flat: one thing drives it out of the plane, or all by little."""
    return (len(found) == 1 and found[0].acts) or all(departure.size < tolerances.NEARLY_FLAT for departure in found)


def _of_couplings(seen: View) -> list[Departure]:
    """What couplings count out of the plane, of a scene whose joints all stand along it or across: why it is none."""
    if not seen.scene.mechanism.couplings or any(stance.off > tolerances.FLAT for stance in seen.stances):
        return []
    from heuncli.multibody.reduction.plane.coupled import leaving  # few scenes have them

    return list(leaving(seen, None))


def _reduction(seen: View) -> Reduction | tuple[str, ...]:
    try:
        flat = flat_scene(seen)
    except NotTold as missing:
        return (f"not solved in the plane across {_direction(seen)}: {missing}",)
    states = States(seen, flat)
    where = f"solved in the plane across {_direction(seen)}: "
    if all(seen.upright):
        why = "the joints leave no other motion than turns about that direction and shifts across it"
        return Reduction(flat, states.embed, states.restrict, (where + why,))
    why = "the scene is its own mirror image in it, and so is its motion, were it stable against leaving it or not"
    hidden = "whether the motion in the plane is stable against leaving it: what is integrated cannot leave it"
    return Reduction(flat, states.embed, states.restrict, (where + why,), (hidden,))


def _direction(seen: View) -> str:
    """The normal in words."""
    n = seen.n
    for k, name in enumerate("xyz"):
        if np.count_nonzero(n) == 1 and n[k] != 0.0:
            return name
    return "({})".format(", ".join(f"{0.0 if abs(x) <= tolerances.FLAT else x:.6g}" for x in n))
