"""Hand-made results and a study made of functions of time, for tests of what comes after the solving."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.stretch import NODES, Stretch
from heuncli.output.tables.page import Page
from heuncli.results.results import SIDE_SIGNS, Array, Block, Extremes, Magnitudes, Results
from heuncli.results.results_paths import PathValues, find_values
from heuncli.results.results_schema import REPORT_OF
from heuncli.study.model.selection import EVERYTHING
from heuncli.study.quantities.labels import ForceInfo, JointInfo, Labels, SectionInfo
from heuncli.study.queries.study import Study

ACCURATE: Block = {
    "energy_drift": 2e-12,
    "constraint_gap": 1e-16,
    "balance_residual": 3e-15,
    "horizon": None,
    "estimate": {
        "motion": 4e-11,
        "reactions": 5e-10,
        "drives": 0.0,
        "foundation": 5e-10,
        "sections": 5e-10,
        "energy": 4e-11,
    },
}
WORK: Block = {
    "kernel": "compiled",
    "steps": 57,
    "evaluations": 812,
    "seconds": {"load": 0.03, "build": 0.004, "integrate": 0.0004, "check": 0.0006, "recover": 0.001},
}
LABELS = Labels(
    joints={"pivot": JointInfo("ball", "ground.O", "upper.top"), "elbow": JointInfo("pin", "upper.end", "lower.top")},
    forces={"push": ForceInfo("force"), "motor": ForceInfo("torque", "elbow")},
    sections={"middle": SectionInfo("lower"), "along": SectionInfo("lower")},
    moment_point="O",
)
UNITS = ("m", "m/s", "m/s²", "rad", "rad/s", "rad/s²", "N", "N·m", "J", "W")
MAGNITUDES = Magnitudes(dict.fromkeys(UNITS, 10.0), size=2.0, reach=1.0, errors={})  # of `pendulum`


def vectors(t: Array, x: Any, y: Any, z: Any) -> Array:
    """Components, each a number or an array over the instants, as (n_t, 3)."""
    return np.stack(np.broadcast_arrays(x, y, z, t)[:3], axis=1).astype(np.float64)


def pendulum(t: Array, **changes: Any) -> Results:
    """Results of every kind over the instants t, as smooth functions of time with known extremes."""
    force = vectors(t, 3.0 * np.sin(2.0 * t), 0.0, 9.81 + np.cos(2.0 * t))
    s = np.linspace(0.0, 0.8, 5)
    along = {name: np.cos(2.0 * t)[:, None] * (k + 1.0) * (1.0 - s) for k, name in enumerate(("N", "Q1", "Q2"))}
    along |= {name: np.sin(2.0 * t)[:, None] * (k + 1.0) * s for k, name in enumerate(("T", "M1", "M2"))}
    zero = np.zeros((len(t), 3))
    joints = {
        "pivot": {"point": zero, "force": force, "moment": zero, "open": []},
        "elbow": {
            "point": vectors(t, np.sin(t), 0.0, -np.cos(t)),
            "force": 0.5 * force,
            "moment": vectors(t, 0.15 * np.sin(2.0 * t), 0.2 * np.sin(2.0 * t), 0.0),
            "open": [],
            "axial": 0.0 * t,
            "radial": 0.5 * np.linalg.norm(force, axis=1),
            "tilting": 0.0 * t,
        },
    }
    wrench = {"force": -force, "moment": zero}
    spec = {"path": "fake.yaml", "sha256": "0" * 64}
    blocks: dict[str, Any] = {
        "bodies": {
            "upper": {"center": vectors(t, np.sin(t), 0.0, -np.cos(t)), "rotation": np.tile(np.eye(3), (len(t), 1, 1))}
        },
        "points": {"lower.end": {"position": vectors(t, np.sin(t), 0.0, -np.cos(t))}},
        "coordinates": {"elbow": {"angle": np.sin(t), "rate": np.cos(t), "acceleration": -np.sin(t)}},
        "foundation": {
            "about": np.zeros(3),
            **wrench,
            "axis": {"point": zero, "direction": vectors(t, 0.0, 0.0, 1.0), "pitch": 0.0 * t},
            "mass_effect": {"force": 0.1 * force, "moment_orbital": zero, "moment_spin": zero},
            "supports": {"pivot": dict(wrench)},
            "elements": {},
        },
        "joints": joints,
        "sections": {
            "middle": {"N": 5.0 + np.cos(2.0 * t), "M1": np.sin(2.0 * t), "open": []},
            "along": {
                "s": s,
                "side": [None, None, "before", "beyond", None],
                "normal": vectors(t, 0.0, 0.0, -1.0),
                "force": np.stack([vectors(t, k, 0.0, 0.0) for k in range(5)], axis=1),
                **along,
            },
        },
        "forces": {
            "push": {"value": 2.0 * np.sin(t), "power": np.sin(t) ** 2},
            "motor": {"value": np.cos(t), "rate": np.sin(t), "power": np.cos(t) * np.sin(t)},
        },
        "energy": {"kinetic": 0.5 * np.sin(t) ** 2, "potential": 0.5 * np.cos(t) ** 2, "work": 0.0 * t},
        "momentum": dict.fromkeys(("total", "moment_orbital", "moment_spin"), zero),
        "system_vector": {"total": zero, "bodies": {"upper": zero}},
        "accuracy": ACCURATE,
    }
    model = {
        "space": "spatial",
        "freedoms": 4,
        "bodies": 2,
        "loops": 0,
        "redundant": 0,
        "method": "dop853",
        "reasons": [],
    }
    status = {"code": "completed", "message": ""}
    return Results("A fake", spec, "0.0", model, status, t, **{**blocks, "work": WORK, **changes})


@dataclass(frozen=True, eq=False)
class FakeStudy:
    """A study whose run is `pendulum`."""

    times: Array
    changes: Mapping[str, Any] = field(default_factory=dict)
    later_warnings: dict[str, None] = field(default_factory=dict)
    unknown: set[float] = field(default_factory=set)
    left_out: set[float] = field(default_factory=set)

    @property
    def setup(self) -> Any:
        """What stands for the scene: a tree."""
        return SimpleNamespace(
            scene=SimpleNamespace(layout=SimpleNamespace(rows=0), mechanism=SimpleNamespace(loads=())),
            selection=EVERYTHING,
        )

    @property
    def results(self) -> Results:
        """At the asked instants."""
        return self.resample(self.times)

    has_one_instant = False

    def find_numbers(self, path: str) -> PathValues:
        """The numbers at a path of the results."""
        return find_values(self.results, path)

    @property
    def search_times(self) -> Array:
        """A grid with seven instants between two asked ones."""
        return np.interp(np.arange(0.0, len(self.times) - 0.999, 0.125), np.arange(len(self.times)), self.times)

    def resample(self, times: Array) -> Results:
        """At any instants."""
        return pendulum(np.asarray(times), **self.changes)

    def compute_reports(self, times: Array, reports: Set[str], setup: Any = None) -> Results:
        """Some reports at any instants; in a search runs have nodes between their cuts, where they are linear."""
        found = restrict(self.resample(times), reports)
        return (
            found
            if setup is None
            else replace(found, sections=dict(at_nodes(*item) for item in found.sections.items()))
        )

    def find_recovery(self, times: Array, reports: Set[str], setup: Any = None, *, keep: bool = False) -> Any:
        """What stands for the answers at any instants: of a tree, in which nothing can be open."""
        joints = [
            SimpleNamespace(joint=SimpleNamespace(name=name), force=block["force"], moment=block.get("moment"))
            for name, block in self.resample(times).joints.items()
        ]
        solutions = SimpleNamespace(times=np.asarray(times))
        return SimpleNamespace(solutions=solutions, resolution=None, setup=setup, requested_joints=joints)

    def compose_reports(self, recovery: Any, reports: Set[str], open_marker: Any = None) -> Results:
        """Some reports of such answers."""
        return self.compute_reports(recovery.solutions.times, reports, recovery.setup)

    def make_impulse_blocks(self, setup: Any) -> list[Block]:
        """Its blows with nodes between the cuts of their runs."""
        return [
            blow | {"sections": {name: blow_at_nodes(own) for name, own in blow.get("sections", {}).items()}}
            for blow in self.results.impulses
        ]

    def with_whole_cuts(self, is_nonlinear: bool) -> Any:
        """What stands for the scene with its series of cuts as stretches."""
        return SimpleNamespace(cuts=[stretch_like(*item) for item in self.results.sections.items() if "s" in item[1]])

    chunk_size = 1000
    search_extremes = Study.search_extremes
    magnitudes = load_magnitudes = MAGNITUDES


def stretch_like(name: str, section: dict[str, Any]) -> Stretch:
    """A stretch with the cuts of a run as its corners."""
    s = section["s"]
    side = np.array([SIDE_SIGNS[x] for x in section.get("side", [None] * len(s))])
    bare = dict.fromkeys(Cuts.__annotations__) | {
        "name": name,
        "n": np.array([0.0, 0.0, 1.0]),
        "plane_tolerance": 1e-12,
    }
    points = s[:, None] * bare["n"]
    return Stretch(Cuts(**bare | {"points": points, "s": s, "side": side}), s, side != 0.0)


def at_nodes(name: str, section: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """A section, a series of cuts with its values at nine nodes between each two cuts."""
    if "s" not in section:
        return name, section
    s, share = section["s"], 0.5 * (NODES + 1.0)
    more: dict[str, Any] = {"s": (s[:-1, None] + np.diff(s)[:, None] * share).ravel()}
    for key, values in section.items():
        if isinstance(values, np.ndarray) and values.shape[1:2] == s.shape:
            change = np.diff(values, axis=1)[:, :, None]
            between = values[:, :-1, None] + change * share.reshape(-1, *[1] * (values.ndim - 2))
            more[key] = between.reshape(len(values), -1, *values.shape[2:])
    return name, section | {"side": [None] * len(more["s"])} | more


def blow_at_nodes(section: Block) -> Block:
    """A section of a blow, a series of cuts with its values at nodes."""
    run = len(section["s"]) if "s" in section else 0
    timed = {key: value[None] if key != "s" and np.shape(value)[:1] == (run,) and run else value
             for key, value in section.items() if key != "side"}  # fmt: skip
    _, found = at_nodes("", timed)
    return {key: value[0] if key in timed and key != "s" and run else value for key, value in found.items()}


def found_extremes(study: FakeStudy, page: Page, wanted: Set[str]) -> Extremes:
    """Those of a page, as the command searches them."""
    return study.search_extremes(page.make_search(), frozenset(wanted), whole=True)


def spec_like(**changes: Any) -> Any:
    """What the commands take from a loaded spec."""
    blank: dict[str, Any] = {"joints": {}, "forces": {}, "sections": {}, "expect": (), "warnings": (), "report": None}
    return SimpleNamespace(**{**blank, **changes})


def restrict(results: Results, wanted: Set[str]) -> Results:
    """The results without the blocks that were not asked for."""
    unasked: dict[str, Any] = {block: {} for block, report in REPORT_OF.items() if report not in wanted}
    return replace(results, **unasked)


BLOW = {
    "time": 0.5,
    "names": ["blow"],
    "bodies": {"upper": {"center_velocity_jump": np.array([1.0, 0.0, 0.0])}},
    "foundation": {"force": np.array([0.0, 0.0, 2.0]), "moment": np.zeros(3)},
    "joints": {"pivot": {"force": np.array([0.0, np.nan, 0.0]), "open": ["force.y"]}},
    "sections": {},
    "energy_jump": 0.25,
}
