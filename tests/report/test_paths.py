"""Paths into the results are those of the JSON."""

from __future__ import annotations

import json
import random
from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.base.spelling import reset_effort
from heuncli.output.tables.export import to_json
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import collect_scene_names
from heuncli.scene.file_format.rules.outcome import find_path_error
from heuncli.study.quantities.channels import iter_channels
from tests.shared.fakes import BLOW, LABELS, pendulum

T = np.linspace(0.0, 2.0, 7)
SUMS = [{"terms": {"joints.a.force.x": 1}, "value": 2.0 * T}]
RESULTS = pendulum(T, impulses=[BLOW], certain_sums=SUMS)


def test_every_walked_quantity_has_its_path() -> None:
    for series in iter_channels(RESULTS, LABELS):
        for component, column in zip(series.components, series.values.T, strict=True):
            path = f"{series.path}.{component}" if component else series.path
            if series.quantity != "side":
                assert np.array_equal(np.atleast_1d(find_values(RESULTS, path).values), column), path


@pytest.mark.parametrize(
    ("path", "timed"),
    [
        ("joints.elbow.force", True),
        ("joints.elbow.force.z", True),
        ("joints.elbow.force.2", True),
        ("joints.elbow.force.3.z", False),
        ("points.lower.end.position.x", True),
        ("foundation.about.x", False),
        ("foundation.supports.pivot.force.y", True),
        ("sections.along.M1.3", True),
        ("sections.along.s.4", False),
        ("impulses.0.foundation.force.z", False),
        ("impulses.0.energy_jump", False),
        ("certain_sums.0.value", True),
        ("system_vector.bodies.upper.x", True),
        ("accuracy.estimate.motion", False),
        ("model.freedoms", False),
        ("time.1", False),
    ],
)
def test_a_path_leads_where_it_leads_in_the_json(path: str, timed: bool) -> None:
    node = json.loads(to_json(RESULTS))
    tokens = path.replace("lower.end", "lower~end").split(".")
    while tokens:
        token = tokens.pop(0).replace("~", ".")
        if isinstance(node, list) and timed and not tokens and token in ("x", "y", "z", "2", "3"):
            node = [row[{"x": 0, "y": 1, "z": 2}.get(token) if token in "xyz" else int(token)] for row in node]
        elif isinstance(node, list):
            node = node[{"x": 0, "y": 1, "z": 2}[token] if token in "xyz" else int(token)]
        else:
            node = node[token]
    found = find_values(RESULTS, path)
    assert found.is_timed == timed
    assert np.array_equal(found.values, np.array(node, dtype=np.float64))


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("joints.elbw.force", "joints has no 'elbw'; known: elbow, pivot"),
        ("joint.elbow", "the results has no 'joint'"),
        ("joints.elbow", "joints.elbow is not a number"),
        ("joints.elbow.force.w", "has no 'w'; known: x, y, z"),
        ("joints.elbow.force.3", "has no '3'"),
        ("joints.elbow.axial.3.y", "has no 'y'"),
        ("impulses.1.energy_jump", "impulses has no '1'"),
        ("status.code", "status.code is not a number"),
        ("model.freedoms.x", "has no 'x'"),
        ("", "the results is not a number"),
    ],
)
def test_a_wrong_path_tells_what_is_known_there(path: str, message: str) -> None:
    with pytest.raises(SpecError) as caught:
        find_values(RESULTS, path)
    assert message in str(caught.value)
    assert caught.value.problems[0].code == "unknown-path"
    if "elbw" in path:
        assert caught.value.problems[0].hint == "did you mean elbow?"


JIB, ENGINE = (load(Path(__file__).parents[2] / "specs" / name) for name in ("jib.yaml", "engine.yaml"))


@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("main.angle", "coordinates.main.angle"),
        ("joints.main.angle", "coordinates.main.angle"),
        ("joints.bore.position", "coordinates.bore.travel"),
        ("big.force.z", "joints.big.force.z"),
        ("joint.big.force.z", "joints.big.force.z"),
        ("joints.big.fx", "joints.big.force.x"),
        ("joints.big.Fx", "joints.big.force.x"),
        ("joints.big.force_x", "joints.big.force.x"),
        ("joints.big.force.X", "joints.big.force.x"),
        ("big.Mz", "joints.big.moment.z"),
        ("big.mag", "joints.big.force"),
        ("joints.big.force.mag", "joints.big.force"),
        ("bodies.crank.z", "bodies.crank.center.z"),
        ("crank.center.x", "bodies.crank.center.x"),
        ("crank.omega.z", "bodies.crank.angular_velocity.z"),
        ("bodies.crank.acceleration.x", "bodies.crank.center_acceleration.x"),
        ("crank.pin.x", "points.crank.pin.position.x"),
        ("foundation.fz", "foundation.force.z"),
        ("foundation.pitch", "foundation.axis.pitch"),
        ("foundation.supports.main.fx", "foundation.supports.main.force.x"),
        ("kinetic", "energy.kinetic"),
        ("gas.value", "forces.gas.value"),
    ],
)
def test_what_was_meant_by_a_path_is_found(path: str, meant: str) -> None:
    what, hint = find_path_error(path, collect_scene_names(ENGINE), {}) or ("", "")
    assert path in what
    assert hint == f"did you mean {meant}?"
    assert find_path_error(meant, collect_scene_names(ENGINE), {}) is None


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("root.M1", "did you mean sections.root.M1?"),
        ("sections.root.mises", "did you mean sections.root.stress.mises?"),
        ("rope.tension", "did you mean joints.rope.tension?"),
        ("along.M2.3", "did you mean sections.along.M2.3?"),
        ("coordinates.rope.length", "known names in coordinates: slew"),
        ("mag", "known names: jib"),
        ("stops.buffer.force", "the model has no stops"),
        ("shaft.angle", "known names: jib, load, slew, rope, root, along"),
        ("slew.colour", "slew is one of the joints; joints.slew has point, force"),
    ],
)
def test_what_nothing_is_like_is_told_with_what_there_is(path: str, hint: str) -> None:
    _, told = find_path_error(path, collect_scene_names(JIB), {"root": False, "along": True}) or ("", "")
    assert (told or "").startswith(hint)


@pytest.mark.parametrize("spec", [JIB, ENGINE], ids=["jib", "engine"])
def test_what_is_proposed_is_there(spec: Spec) -> None:
    names = collect_scene_names(spec)
    runs = {name: section.from_ is not None for name, section in spec.sections.items()}
    words = [*spec.bodies, *spec.joints, *spec.forces, *spec.sections, "joints", "coordinates", "force", "fx", "Mz",
             "z", "mag", "angle", "3", "", "supports", "M1", "shares", "gravity", "impulses", "nonsense"]  # fmt: skip
    draw, proposed = random.Random(1), 0
    for _ in range(150):
        reset_effort()
        path = ".".join(draw.choice(words) for _ in range(draw.randint(1, 4)))
        hint = (find_path_error(path, names, runs) or ("", ""))[1] or ""
        if hint.startswith("did you mean ") and "." in hint:
            proposed += 1
            assert find_path_error(hint.removeprefix("did you mean ").removesuffix("?"), names, runs) is None, path
    assert proposed > 5


def test_after_the_run_a_path_is_read_the_same_way() -> None:
    with pytest.raises(SpecError) as caught:
        find_values(RESULTS, "elbow.fz")
    assert caught.value.problems[0].hint == "did you mean joints.elbow.force.z?"
