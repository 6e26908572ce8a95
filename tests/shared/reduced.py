"""A scene solved by the smallest model against the same solved in full: equal numbers, identical verdicts."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

BLOCKS = ("bodies", "points", "coordinates", "foundation", "joints", "stops", "sections", "forces", "energy",
          "system_vector", "couplings")  # fmt: skip
ROUNDING = 1e-11  # of the largest of a kind, beside what both runs say of themselves
# directions of what may be zero; the rest are functions of what is compared, of half turns beyond all bounds
UNTOLD = ("axis", "line", "stress", "rodrigues")
SPINS = ("moment", "M1", "M2", "T")


class Pair(NamedTuple):
    """The same scene in full and reduced."""

    full: Study
    small: Study

    @property
    def told(self) -> tuple[str, ...]:
        """What was left out."""
        reduced = self.small.setup.reduction
        return reduced.explanations if reduced is not None else ()


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
    assert full.status["code"] == small.status["code"], small.status["message"]
    for name in ("freedoms", "redundant", "loops", "bodies", "driven"):
        assert full.model[name] == small.model[name], name
    assert [dict.fromkeys(s["terms"]) for s in full.certain_sums] == [
        dict.fromkeys(s["terms"]) for s in small.certain_sums
    ], "other certain sums"
    assert blamed(full) == blamed(small), f"warned otherwise: {sorted(blamed(full) ^ blamed(small))}"
    n = known(both)
    largest = sizes(both.full, one)
    slender = slenderness(both.full)
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
        size = largest["total" if path.startswith("system_vector") else kind_of(path)]
        words = path.split(".")
        thin = slender.get(words[1], 1.0) if words[0] == "bodies" and words[-1] in ANGULAR else 1.0
        allowed = (estimate(both, path) * thin + ROUNDING * thin**2) * size
        assert difference <= allowed, f"{path}: off by {difference:.3g}, {difference / size:.1e} of {size:.3g}"
        worst = max(worst, difference / (size or 1.0))
    return worst


def slenderness(study: Study) -> dict[str, float]:
    """The scene's size over each body's least radius of gyration.

    By its square a rounding of the moments about a thin body's axis turns it more than others; by itself an error of
    its turn is more than that of its points, which are what a run estimates.
    """
    size, found = study.setup.scene.layout.size, {}
    for body in study.setup.scene.mechanism.bodies:
        moments = np.linalg.eigvalsh(body.inertia)
        moments = moments[moments > tolerances.NO_INERTIA * moments[2]]  # what has none is not turned by rounding
        if len(moments):
            found[body.name] = max(1.0, size / math.sqrt(moments[0] / body.mass))
    return found


def estimate(both: Pair, path: str) -> float:
    """What the runs say of the error of a value, relative to the largest of its kind: the sum of both."""
    kinds = ESTIMATED.get(path.split(".")[0])
    told = [dict[str, Any](study.results.accuracy["estimate"]) for study in both]
    return sum(max((float(e[k]) for k in e if kinds is None or k in kinds), default=0.0) for e in told)


def blamed(results: Results) -> set[str]:
    """The warnings without their numbers; not those of how a run went, which is its own affair."""
    told = {re.sub(r"[-+.\de]*\d[-+.\de]*", "0", w) for w in results.warnings}
    return {w for w in told if not w.startswith(OF_THE_RUN)}


def numeric(value: Any) -> bool:
    """Whether a list is one of numbers."""
    return (
        not isinstance(value, str)
        and np.asarray(value, dtype=object).size > 0
        and not any(isinstance(x, str) for x in np.asarray(value, dtype=object).ravel())
    )


def known(both: Pair) -> int:
    """How many instants lie before either horizon."""
    time = both.full.results.time
    horizons = [study.results.accuracy.get("horizon") for study in both]
    return int(min(np.searchsorted(time, np.inf if h is None else h) for h in horizons))


def kind_of(path: str) -> str:
    """The last word of a path; a coupling's normal is a force."""
    word = path.rsplit(".", 1)[-1]
    return "force" if word == "normal" and path.startswith("couplings.") else word


def sizes(study: Study, found: Mapping[str, Any]) -> dict[str, float]:
    """What numbers of each kind are measured in, by the last word of their path: the largest of the kind, or what the
    scene's length, forces and masses make of it where that is more.
    """
    largest: dict[str, float] = {}
    for path, value in found.items():
        if numeric(np.atleast_1d(np.asarray(value, dtype=object)).tolist()):
            kind = kind_of(path)
            own = float(np.nan_to_num(np.abs(np.asarray(value, dtype=float))).max(initial=0.0))
            largest[kind] = max(largest.get(kind, 0.0), own)
    scales = scales_of(study, largest)
    found_of = {}
    for kind, own in largest.items():
        alike = [largest.get(name, 0.0) for name in ALIKE.get(kind, ())]
        found_of[kind] = max([own, *alike, *(scales[word] for word in MEASURED.get(kind, ()))])
    return found_of


def scales_of(study: Study, largest: Mapping[str, float]) -> dict[str, float]:
    """A scene's length, force, speed and so on, by letters of the mechanics' books."""
    scene = study.setup.scene
    mass = sum(body.mass for body in scene.mechanism.bodies)
    L = max(scene.layout.size, largest["position"])
    g = float(np.abs(scene.mechanism.gravity).max())
    turning = largest["angular_acceleration"] + largest["angular_velocity"] ** 2  # what is estimated are places
    a = max(g, largest["center_acceleration"], L * turning)
    forces, moments = ([largest.get(name, 0.0) for name in names] for names in (FORCES, MOMENTS))
    F = max([mass * a, *forces, *(moment / L for moment in moments)])
    v = max(largest["center_velocity"], L * largest["angular_velocity"], math.sqrt(F / mass * L))
    return {
        "L": L,
        "a": F / mass,
        "v": v,
        "F": F,
        "FL": F * L,
        "w": v / L,
        "al": F / mass / L,
        "1": 1.0,
        "Fv": F * v,
        "mv": mass * v,
        "mvL": mass * v * L,
    }


OF_THE_RUN = ("tolerance 0 not reached", "in 0 steps the loads could not be checked")
ANGULAR = ("rotation", "angular_velocity", "angular_acceleration")
# the estimates that speak for the values of a block; of what is missing here the worst of all
ESTIMATED = {
    "joints": ("reactions", "drives"), "stops": ("reactions", "drives"),
    "foundation": ("foundation", "reactions", "drives"), "sections": ("sections",), "energy": ("energy", "motion"),
}  # fmt: skip
FORCES = ("force", "N", "Q1", "Q2", "axial", "radial", "tension", "last_tension", "tight", "slack", "along", "aside",
          "friction", "contact", "thrust")  # fmt: skip
MOMENTS = ("moment", "torque", "T", "M1", "M2", "tilting", "moment_orbital", "moment_spin")
ENERGIES = ("kinetic", "potential", "work", "energy")
ALIKE = {kind: among for among in (FORCES, MOMENTS, ENERGIES) for kind in among}
MEASURED: dict[str, tuple[str, ...]] = {  # by scales_of: all kinds that may be nothing but rounding
    **dict.fromkeys(FORCES, ("F",)), **dict.fromkeys(MOMENTS, ("FL",)), **dict.fromkeys(ENERGIES, ("FL",)),
    **dict.fromkeys(("position", "center", "travel", "point", "contact_point", "about", "length"), ("L",)),
    **dict.fromkeys(("velocity", "center_velocity", "speed", "center_velocity_jump"), ("v",)),
    **dict.fromkeys(("angular_velocity", "angular_velocity_jump"), ("w",)), "rate": ("v", "w"),
    "angle": ("1",), "rotation": ("1",), "normal": ("1",), "first_axis": ("1",),
    **dict.fromkeys(("acceleration", "center_acceleration"), ("a", "al")), "angular_acceleration": ("al",),
    "momentum": ("mv",), "moment_of_momentum": ("mvL",),
    "total": ("Fv",), "value": ("F", "FL"), "power": ("Fv",), "drive": ("F", "FL"),
    **dict.fromkeys(("energy_before", "energy_after", "energy_jump"), ("FL",)),
}  # fmt: skip
