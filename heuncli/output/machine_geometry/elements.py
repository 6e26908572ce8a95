"""The geometry of machine elements on the bodies that carry them, by the name of the body or of the ground."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.pitch_lines import BeltGeometry, PitchPoint, make_pitch_geometry
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND

SAME_DISC = 1e-9  # of the radius: discs whose centres, radii and axes differ by less are one


class ElementGeometry(NamedTuple):
    """Discs and lines of each body, in its axes; belts, and the points at which gears mesh."""

    discs: dict[str, list[Disc]]
    lines: dict[str, list[Array]]
    belts: tuple[BeltGeometry, ...] = ()
    pitch_points: tuple[PitchPoint, ...] = ()


NO_ELEMENTS = ElementGeometry({}, {})


def collect_elements(spec: Spec, mechanism: Mechanism | None) -> ElementGeometry:
    """Collect the geometry of all machine elements of a spec.

    mechanism: as assembled, for the sheaves of its ropes, which a spec alone does not determine
    """
    kinds = {own.type for own in spec.couplings.values()} | {"wheel" for _ in spec.rolling}
    kinds |= {"curve" for own in spec.joints.values() if own.path is not None}
    if not kinds:
        return NO_ELEMENTS
    lines = defaultdict[str, list[Array]](list)
    pitch = make_pitch_geometry(spec)
    for body, racks in pitch.racks.items():
        lines[body] += racks
    if kinds & {"cam", "curve"}:
        from heuncli.output.machine_geometry.cams import iter_cam_outlines, iter_paths  # few scenes have them

        for body in (*spec.bodies, GROUND):
            lines[body] += (*iter_cam_outlines(spec, body), *iter_paths(spec, body))
    if "screw" in kinds:
        from heuncli.output.machine_geometry.threads import make_threads  # few scenes have screws

        for body, threads in make_threads(spec).items():
            lines[body] += threads
    discs = defaultdict[str, list[Disc]](list)
    for body, own in _iter_discs(spec, mechanism, pitch.discs):
        if not any(are_same_disc(own, other) for other in discs[body]):
            discs[body].append(own)
    return ElementGeometry(discs, lines, tuple(pitch.belts), tuple(pitch.points))


def _iter_discs(spec: Spec, mechanism: Mechanism | None, gears: dict[str, list[Disc]]) -> Iterator[tuple[str, Disc]]:
    """Yield all discs, each with its body."""
    from heuncli.output.machine_geometry.cams import iter_path_rollers
    from heuncli.output.machine_geometry.discs import iter_wheel_discs

    yield from iter_wheel_discs(spec)
    yield from ((body, disc) for body, own in gears.items() for disc in own)
    yield from iter_path_rollers(spec)
    if mechanism is not None and any(own.type == "rope" for own in spec.couplings.values()):
        from heuncli.output.machine_geometry.ropes import iter_sheaves

        yield from iter_sheaves(mechanism)


def are_same_disc(first: Disc, second: Disc) -> bool:
    """Return whether two discs coincide, as when a planet meshes with the sun and with the ring."""
    difference = np.concatenate([first.centre - second.centre, [first.radius - second.radius]])
    across = np.cross(first.axis, second.axis)
    return float(difference @ difference) <= (SAME_DISC * first.radius) ** 2 and float(across @ across) <= SAME_DISC**2
