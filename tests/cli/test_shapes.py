"""Shapes come from the schema of results: three cuts, three bodies or three instants are no vector, nor are four.

One scene with runs of 1, 2, 3, 4 and 9 cuts, as many instants and up to three bodies: what `--measure` and `expect`
tell of its numbers does not depend on how many there are of them.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.output.tables.export import to_csv
from heuncli.results.path_words import find_quantity
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import CUT, IMPULSES, REPORTS, SHARES, independent_axes
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.measure import MeasureRequest, NotOneNumber, measure_value
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.command import Heun

BAR = """\
  b{0}:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 10 mm, mass: 1}}]
    points: {{top: [0, 0, 0], end: [1, 0, 0]}}
"""
JOINT = "  j{0}: {{type: pin, from: {1}, to: b{0}.top, axis: [0, 1, 0], initial: {{rate: 1}}}}\n"
ALONG = "from: top, to: end, count: {}"
SCENE = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
{bodies}joints:
{joints}forces: {{push: {{type: force, on: b0.end, vector: ["3*sin(5*t)", 1, -3]}}}}
impulses: {{blow: {{on: b0.end, vector: [0, 1, 2], time: 0.1}}}}
sections: {{s: {{body: b0, {cuts}, reduce_to: line, properties: auto, strength: 100 MPa}}}}
analysis: {{duration: 0.2, samples: {instants}, events: {{e: "j0.angle > 0.01"}}}}
report: [motion, points, foundation, joints, sections, forces, energy, impulses, events, shares]
"""
COUNTS = [(1, 2, 2), (1, 3, 3), (1, 4, 4), (1, 9, 3), (1, 1, 3), (3, 3, 3)]  # bodies, cuts, instants
each = pytest.mark.parametrize("count", COUNTS)


def text(bodies: int, cuts: int, instants: int) -> str:
    return SCENE.format(
        bodies="".join(BAR.format(i) for i in range(bodies)),
        joints="".join(JOINT.format(i, "ground.O" if i == 0 else f"b{i - 1}.end") for i in range(bodies)),
        cuts=ALONG.format(cuts) if cuts > 1 else "at: [0.5, 0, 0], normal: [1, 0, 0]",
        instants=instants,
    )


@cache
def study_of(count: tuple[int, int, int]) -> Study:
    return solve(load("x.yaml", text(*count)), Options(requested_reports=frozenset({*REPORTS, SHARES})))


def leaves(block: Any, keys: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """All that stands in the results, with its keys."""
    for key, part in block.items() if isinstance(block, dict) else enumerate(block):
        if isinstance(part, dict) or (isinstance(part, list) and part and isinstance(part[0], dict)):
            yield from leaves(part, (*keys, str(key)))
        else:
            yield (*keys, str(key)), part


def numbers_of(study: Study) -> Iterator[tuple[str, Any]]:
    """The paths of all quantities of a run, with what stands there."""
    whole = {f.name: getattr(study.results, f.name) for f in fields(study.results)}
    for keys, part in leaves(whole):
        row = find_quantity(keys)
        if row is not None and row.units:
            yield ".".join(keys), part


@each
def test_every_array_has_the_axes_of_the_schema(count: tuple[int, int, int]) -> None:
    _, cuts, instants = count
    for path, part in numbers_of(study_of(count)):
        there = find_values(study_of(count).results, path)
        sizes = tuple(cuts if axis is CUT else axis.size for axis in there.axes)
        shape = (instants, *sizes) if there.is_timed else sizes
        got = np.shape(np.nan if part is None else part)
        assert len(got) == len(shape) and all(b in (a, None) for a, b in zip(got, shape, strict=True)), path


def extreme(study: Study, how: str, path: str) -> float | str:
    """What --measure tells, or that it refuses."""
    try:
        return measure_value(MeasureRequest(how, path), study).value  # type: ignore[arg-type]
    except NotOneNumber as error:
        return re.sub(r"\d+", "N", error.problems[0].message)


OF_ONE = "bodies.b0.c", "sections.s.", "foundation.f", "joints.j0.f", "energy.k", "impulses.0.sections", "events"


@pytest.mark.heavy
@pytest.mark.parametrize(("how", "of", "least"), [("abs", OF_ONE, 40), ("min", ("sections.s.M",), 2)])
def test_an_extreme_does_not_depend_on_how_many_cuts_and_instants_are_asked_for(
    how: str, of: tuple[str, ...], least: int
) -> None:
    paths = [path for path, _ in numbers_of(study_of((1, 3, 3))) if path.startswith(of) and SHARES not in path]
    paths.append("sections.s.shares.gravity.M1")
    assert len(paths) > least
    for path in paths:
        found = [extreme(study_of(count), how, path) for count in COUNTS[:2]]
        assert found[1:] == found[:1] or found == pytest.approx(found[:1] * 2, rel=1e-6, abs=1e-7), path


@each
def test_at_an_instant_a_list_of_three_cuts_is_no_vector(count: tuple[int, int, int]) -> None:
    for path in ("sections.s.M2", "sections.s.force", "joints.j0.force", "bodies.b0.rotation", "bodies.b0.quaternion"):
        there = find_values(study_of(count).results, path)
        if not there.axes or (there.is_vector and len(there.axes) == 1):
            assert isinstance(measure_value(MeasureRequest("final", path), study_of(count)).value, float)
        else:
            with pytest.raises(NotOneNumber, match="choose one") as caught:
                measure_value(MeasureRequest("final", path), study_of(count))
            one = str(caught.value.problems[0].hint).rpartition(": ")[2]
            assert isinstance(measure_value(MeasureRequest("final", one), study_of(count)).value, float)


@each
def test_csv_names_every_number_by_its_path(count: tuple[int, int, int]) -> None:
    study = study_of(count)
    rows = list(csv.DictReader(io.StringIO(to_csv(study.results, make_labels(study.spec)))))
    told = [row for row in rows if row["kind"] not in (IMPULSES, "event", "events") and row["quantity"] != "side"]
    assert len(told) > 150
    for row in told:
        share = f"shares.{row['cause']}" if row["cause"] else ""
        parts = (row["kind"], row["name"], share, row["quantity"], row["component"])
        there = find_values(study.results, ".".join(part for part in parts if part))
        at = np.flatnonzero(study.results.time == float(row["time"])) if there.is_timed else [()]
        assert not there.axes
        assert (repr(float(there.values[at[0]] + 0.0)) if row["value"] else "nan") == (row["value"] or "nan"), row


@pytest.mark.heavy
@pytest.mark.parametrize("cuts", [2, 3, 4])
def test_expectations_of_lists_go_by_the_schema(heun: Heun, cuts: int) -> None:
    study = study_of((1, cuts, cuts))
    at = float(study.results.time[1])
    lines = []
    for path, how, is_ in [
        ("sections.s.M1", f"at: {at!r}", find_values(study.results, "sections.s.M1").values[1].tolist()),
        ("sections.s.N", "peak: abs", extreme(study, "abs", "sections.s.N")),
        ("sections.s.force", "peak: abs", extreme(study, "abs", "sections.s.force")),
        ("joints.j0.force", "peak: abs", extreme(study, "abs", "joints.j0.force")),
        ("joints.j0.force.x", "peak: min", extreme(study, "min", "joints.j0.force.x")),
        ("sections.s.M1.1", f"at: {at!r}", float(find_values(study.results, "sections.s.M1.1").values[1])),
    ]:
        lines.append(f"  - {{of: {path}, {how}, is: {is_}}}\n")
    top = max(extreme(study, how, "sections.s.M1") for how in ("max", "min"))  # type: ignore[type-var]
    lines.append(f"  - {{of: sections.s.M1, below: {float(top) + 1e-3}}}\n")  # type: ignore[arg-type]
    done = heun("check", "-", "--format", "json", text=text(1, cuts, cuts) + "expect:\n" + "".join(lines))
    assert json.loads(done.stdout)["failed"] == 0, done.stdout + done.stderr


@pytest.mark.parametrize("cuts", [2, 3, 4])
def test_one_entry_alone_has_the_same_shape(heun: Heun, cuts: int) -> None:
    done = heun("run", "-", "--only", "sections.s", "--format", "json", text=text(1, cuts, 3))
    block = json.loads(done.stdout)["sections"]["s"]
    assert (np.shape(block["M1"]), np.shape(block["force"]), np.shape(block["s"])) == ((3, cuts), (3, cuts, 3), (cuts,))
    table = heun("run", "-", "--only", "sections.s", "--all", text=text(1, cuts, 2)).stdout
    assert len(re.findall(r"^\s*0(?:\.\d+)?\s", table, re.MULTILINE)) >= cuts


@pytest.mark.parametrize("path", ["bodies.b0.quaternion", "bodies.b0.rotation"])
def test_an_attitude_has_no_extreme_and_no_limit(heun: Heun, path: str) -> None:
    assert independent_axes(find_values(study_of((1, 3, 3)).results, path).axes)
    scene = text(1, 3, 3)
    done = heun("run", "-", "--measure", f"max {path}", text=scene)
    assert (done.returncode, "choose one" in done.stderr) == (2, True)
    watched = scene.replace('e: "j0.angle > 0.01"', f"e: {{of: {path}, below: 0.5}}")
    done = heun("run", "-", text=watched)
    assert (done.returncode, "is several numbers [event-path]" in done.stderr) == (2, True)
    for item in (f"{{of: {path}, peak: max, is: 1}}", f"{{of: {path}, below: 2}}"):
        done = heun("check", "-", text=f"{scene}expect:\n  - {item}\n")
        assert (done.returncode, f"as {path}." in done.stderr) == (2, True), done.stderr
