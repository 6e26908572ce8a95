"""A scene solved by the smallest model against the same solved in full: equal numbers, identical verdicts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from heuncli.results import Results
from heuncli.spec.models import Spec
from heuncli.study.solve import Options, Study, solve

BLOCKS = ("bodies", "points", "coordinates", "foundation", "joints", "stops", "sections", "forces", "energy",
          "system_vector")  # fmt: skip
NOTHING = 1e-25  # squares of roundings of what is zero
ROUNDING = 1e-11  # of the largest of a kind, beside what both runs say of themselves
UNTOLD = ("axis", "line", "stress")  # directions of what may be zero; the rest are functions of what is compared
SPINS = ("moment", "M1", "M2", "T")


class Pair(NamedTuple):
    """The same scene in full and reduced."""

    full: Study
    small: Study

    @property
    def told(self) -> tuple[str, ...]:
        """What was left out."""
        reduced = self.small.setup.reduced
        return reduced.told if reduced is not None else ()


def pair(spec: Spec, **options: Any) -> Pair:
    """A scene solved both ways."""
    return Pair(solve(spec, Options(reduce=False, **options)), solve(spec, Options(**options)))


def leaves(block: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a block by their paths."""
    if isinstance(block, Mapping):
        for name, value in block.items():
            if name not in UNTOLD:
                yield from leaves(value, f"{path}.{name}" if path else str(name))
    elif isinstance(block, list) and block and isinstance(block[0], Mapping):
        for k, value in enumerate(block):
            yield from leaves(value, f"{path}.{k}")
    else:
        yield path, block


def values(results: Results) -> dict[str, Any]:
    """All values of the blocks, and of the blows, by their paths."""
    found = {f"{name}.{path}": value for name in BLOCKS for path, value in leaves(getattr(results, name))}
    return found | dict(leaves(results.impulses, "impulses"))


def same(both: Pair) -> float:
    """Assert equal numbers, within what both say of their errors, and identical verdicts; the largest deviation."""
    full, small = both.full.results, both.small.results
    one, other = values(full), values(small)
    assert one.keys() == other.keys()
    assert full.status["code"] == small.status["code"]
    for name in ("freedoms", "redundant", "loops", "bodies", "driven"):
        assert full.model[name] == small.model[name], name
    assert [dict.fromkeys(s["terms"]) for s in full.certain_sums] == [
        dict.fromkeys(s["terms"]) for s in small.certain_sums
    ]
    n = known(both)
    estimate = max((*full.accuracy["estimate"].values(), *small.accuracy["estimate"].values()), default=0.0)
    largest = sizes(one)
    worst = 0.0
    for path, value in one.items():
        if isinstance(value, str | list | tuple) and not numeric(value):
            assert value == other[path], path
            continue
        a, b = (np.atleast_1d(np.asarray(x, dtype=float)) for x in (value, other[path]))
        if len(a) == len(full.time) > 1 and not path.startswith("impulses"):
            a, b = a[:n], b[:n]
        assert a.shape == b.shape, path
        assert np.array_equal(np.isnan(a), np.isnan(b)), f"{path}: open at other places"
        difference = float(np.nan_to_num(np.abs(a - b)).max(initial=0.0))
        size = largest[path.rsplit(".", 1)[-1]]
        allowed = (2.0 * estimate + ROUNDING) * size + NOTHING
        assert difference <= allowed, f"{path}: off by {difference:.3g}, {difference / size:.1e} of {size:.3g}"
        worst = max(worst, difference / (size or 1.0))
    return worst


def numeric(value: Any) -> bool:
    """Whether a list is one of numbers."""
    return not isinstance(value, str) and np.asarray(value, dtype=object).size > 0 and not any(
        isinstance(x, str) for x in np.asarray(value, dtype=object).ravel()
    )


def known(both: Pair) -> int:
    """How many instants lie before either horizon."""
    time = both.full.results.time
    horizons = [study.results.accuracy.get("horizon") for study in both]
    return int(min(np.searchsorted(time, np.inf if h is None else h) for h in horizons))


def sizes(found: Mapping[str, Any]) -> dict[str, float]:
    """The largest number of each kind, by the last word of its path; of lengths and times their own rates'."""
    largest: dict[str, float] = {}
    for path, value in found.items():
        if isinstance(value, str) or not numeric(np.atleast_1d(np.asarray(value, dtype=object)).tolist()):
            continue
        kind = path.rsplit(".", 1)[-1]
        own = float(np.nan_to_num(np.abs(np.asarray(value, dtype=float))).max(initial=0.0))
        largest[kind] = max(largest.get(kind, 0.0), own)
    for kind, among in ALIKE.items():
        if kind in largest:
            largest[kind] = max(largest.get(name, 0.0) for name in among)
    # what is estimated are places: velocities and accelerations err by as much of what turning makes of them
    rate, length = largest.get("angular_velocity", 0.0), largest.get("center", 0.0)
    turned = {"velocity": rate * length, "acceleration": rate**2 * length}
    turned |= {f"center_{kind}": size for kind, size in turned.items()} | {"angular_acceleration": rate**2}
    return largest | {kind: max(largest.get(kind, 0.0), size) for kind, size in turned.items()}


FORCES = ("force", "N", "Q1", "Q2", "axial", "radial", "tension")
MOMENTS = ("moment", "T", "M1", "M2", "tilting", "moment_orbital", "moment_spin")
ENERGIES = ("kinetic", "potential", "work")
ALIKE = {kind: among for among in (FORCES, MOMENTS, ENERGIES) for kind in among} | {
    "speed": ("speed", "velocity", "center_velocity"), "travel": ("travel", "position"),
    "rate": ("rate", "angular_velocity"), "acceleration": ("acceleration", "center_acceleration",
                                                           "angular_acceleration"),
}  # fmt: skip
