"""What machine elements look like on the bodies that carry them, by the bodies' names and that of the ground."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.pitch_lines import BeltLook, pitch_looks
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND

ONE = 1e-9  # of its radius: a disc that stands where another one does is that one


class ElementLooks(NamedTuple):
    """Round things and lines of each body, in its axes, and belts."""

    discs: dict[str, list[Disc]]
    lines: dict[str, list[Array]]
    belts: tuple[BeltLook, ...] = ()


NONE = ElementLooks({}, {})


def elements_of(spec: Spec, mechanism: Mechanism | None) -> ElementLooks:
    """All of them; mechanism: as assembled, for the sheaves of its ropes, which a spec alone does not tell."""
    kinds = {own.type for own in spec.couplings.values()} | {"wheel" for _ in spec.rolling}
    kinds |= {"curve" for own in spec.joints.values() if own.path is not None}
    if not kinds:
        return NONE
    lines = defaultdict[str, list[Array]](list)
    pitch = pitch_looks(spec)
    for body, racks in pitch.racks.items():
        lines[body] += racks
    if kinds & {"cam", "curve"}:
        from heuncli.output.machine_geometry.cams import cam_outlines, paths_of  # few scenes have them

        for body in (*spec.bodies, GROUND):
            lines[body] += (*cam_outlines(spec, body), *paths_of(spec, body))
    if "screw" in kinds:
        from heuncli.output.machine_geometry.threads import threads_of  # few scenes have screws

        for body, threads in threads_of(spec).items():
            lines[body] += threads
    discs = defaultdict[str, list[Disc]](list)
    for body, own in _discs(spec, mechanism, pitch.discs):
        if not any(same(own, other) for other in discs[body]):
            discs[body].append(own)
    return ElementLooks(discs, lines, tuple(pitch.belts))


def _discs(spec: Spec, mechanism: Mechanism | None, gears: dict[str, list[Disc]]) -> Iterator[tuple[str, Disc]]:
    """Everything that is round and turns."""
    from heuncli.output.machine_geometry.cams import rollers_of
    from heuncli.output.machine_geometry.wheels import wheel_discs

    yield from wheel_discs(spec)
    yield from ((body, disc) for body, own in gears.items() for disc in own)
    yield from rollers_of(spec)
    if mechanism is not None and any(own.type == "rope" for own in spec.couplings.values()):
        from heuncli.output.machine_geometry.ropes import sheaves_of

        yield from sheaves_of(mechanism)


def same(one: Disc, other: Disc) -> bool:
    """Whether two are one: a planet meshes with the sun and with the ring."""
    off = np.concatenate([one.centre - other.centre, [one.radius - other.radius]])
    across = np.cross(one.axis, other.axis)
    return float(off @ off) <= (ONE * one.radius) ** 2 and float(across @ across) <= ONE**2
