"""One walk over the results: every number that runs over the instants, with its path, components and unit.

The paths are those of the JSON (contract section 3): `joints.elbow.force.z` is kind `joints`, name `elbow`, quantity
`force`, component `z`; in a run of cuts the component begins with the number of the cut, `3.z`. What is added to the
results later needs at most a row in UNITS.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from heuncli.report.scene import Scene
from heuncli.results import Array, Block, Results
from heuncli.results_schema import TIMED, XYZ, is_static

OF_ALL_CUTS = frozenset({"normal", "first_axis"})  # in a run of cuts not one a cut

UNITS = {
    "position": "m",
    "center": "m",
    "point": "m",
    "pressure_centre": "m",
    "pitch": "m",
    "length": "m",
    "travel": "m",
    "s": "m",
    "velocity": "m/s",
    "center_velocity": "m/s",
    "center_velocity_jump": "m/s",
    "speed": "m/s",
    "rate": "rad/s",
    "angular_velocity": "rad/s",
    "angular_velocity_jump": "rad/s",
    "acceleration": "m/s²",
    "center_acceleration": "m/s²",
    "angular_acceleration": "rad/s²",
    "angle": "rad",
    "rotation": "1",
    "direction": "1",
    "normal": "1",
    "first_axis": "1",
    "side": "1",
    "force": "N",
    "axial": "N",
    "radial": "N",
    "tension": "N",
    "N": "N",
    "Q1": "N",
    "Q2": "N",
    "direct_force": "N",
    "moment": "N·m",
    "moment_orbital": "N·m",
    "moment_spin": "N·m",
    "direct_moment": "N·m",
    "tilting": "N·m",
    "T": "N·m",
    "M1": "N·m",
    "M2": "N·m",
    "power": "W",
    "kinetic": "J",
    "potential": "J",
    "work": "J",
    "energy_jump": "J",
    "normal_max": "Pa",
    "normal_min": "Pa",
    "shear_torsion": "Pa",
    "shear_mean": "Pa",
    "mises": "Pa",
    "utilisation": "1",
}
SYSTEM_VECTOR_UNIT = "N·m/s"  # theory.md 2h: Σ m ẋ × ẍ
IMPULSE_UNITS = {"N": "N·s", "N·m": "N·m·s"}
SIDES = {None: np.nan, "before": -1.0, "beyond": 1.0}


class Series(NamedTuple):
    """One quantity over the instants: `values` is (n_t, n_components), or (1, n_components) where `static`."""

    kind: str
    name: str
    quantity: str
    unit: str
    components: tuple[str, ...]
    values: Array
    static: bool = False

    @property
    def path(self) -> str:
        """The quantity's path in the JSON, without component."""
        return ".".join(part for part in (self.kind, self.name, self.quantity) if part)


def walk(results: Results, scene: Scene) -> Iterator[Series]:
    """Every quantity of the results that runs over the instants, in the order of the JSON."""
    for kind in TIMED:
        yield from _block(kind, (), getattr(results, kind), scene)


def walk_impulse(block: Block, scene: Scene) -> Iterator[Series]:
    """Every quantity of one block of `impulses`, as if at one instant; forces become impulses in unit."""
    for kind, part in block.items():
        if kind in ("time", "names"):
            continue
        whole = _at_one_instant(kind, (), part if isinstance(part, dict) else {kind: part})
        for series in _block(kind if isinstance(part, dict) else "", (), whole, scene):
            yield series._replace(unit=IMPULSE_UNITS.get(series.unit, series.unit))


def component_labels(shape: tuple[int, ...]) -> tuple[str, ...]:
    """Names of the components of an array of this shape: x, y, z where there are three, else numbers."""
    labels: tuple[str, ...] = ("",)
    for size in shape:
        own = XYZ if size == 3 else tuple(str(i) for i in range(size))
        labels = tuple(f"{outer}.{inner}" if outer else inner for outer in labels for inner in own)
    return labels


def _block(kind: str, keys: tuple[str, ...], block: Block, scene: Scene, cuts: int = 0) -> Iterator[Series]:
    if kind == "sections" and keys and "s" in block:
        cuts = len(block["s"])
    for key, value in block.items():
        if isinstance(value, dict):
            yield from _block(kind, (*keys, key), value, scene, cuts)
        elif not is_static(kind, keys, key):
            if isinstance(value, np.ndarray):
                yield _series(kind, (*keys, key), value, scene, cuts)
        elif key == "s":
            yield _static(kind, keys, key, np.asarray(value, dtype=np.float64))
        elif key == "side" and any(side is not None for side in value):
            yield _static(kind, keys, key, np.array([SIDES[side] for side in value]))


def _series(kind: str, keys: tuple[str, ...], values: Array, scene: Scene, cuts: int) -> Series:
    name, quantity = ".".join(keys[:-1]), keys[-1]
    unit = scene.unit(kind, name, quantity) or UNITS.get(quantity, "1")
    if kind == "system_vector":
        unit = SYSTEM_VECTOR_UNIT
    if cuts and quantity not in OF_ALL_CUTS:
        inner = component_labels(values.shape[2:])
        labels = tuple(f"{cut}.{part}" if part else str(cut) for cut in range(cuts) for part in inner)
    else:
        labels = component_labels(values.shape[1:])
    return Series(kind, name, quantity, unit, labels, values.reshape(values.shape[0], -1))


def _static(kind: str, keys: tuple[str, ...], quantity: str, values: Array) -> Series:
    labels = tuple(str(i) for i in range(len(values)))
    return Series(kind, ".".join(keys), quantity, UNITS[quantity], labels, values[None, :], static=True)


def _at_one_instant(kind: str, keys: tuple[str, ...], block: Block) -> Block:
    """The block with a time axis of one instant before every array and number."""
    return {
        key: _at_one_instant(kind, (*keys, key), value)
        if isinstance(value, dict)
        else value
        if is_static(kind, keys, key) or key == "open"
        else np.asarray(value, dtype=np.float64)[None]
        for key, value in block.items()
    }
