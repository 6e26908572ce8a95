"""`heun probe`: what it writes, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.shared.command import Heun

BODY = "{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], angular_velocity: [0.5, 1, 0.2]}"
SCENE = f"heun: 1\ntitle: A free body\nbodies: {{b: {BODY}}}\nanalysis: {{duration: DUR, samples: 3}}\n"


@pytest.mark.heavy
def test_json_keeps_to_the_contract(heun: Heun, folder: Path) -> None:
    (folder / "free.yaml").write_text(SCENE.replace("DUR", "8"))
    done = heun("probe", "free.yaml", "--format", "json")
    found = json.loads(done.stdout)
    assert done.returncode == 0
    assert {"horizon", "stiffness", "growth_rate", "condition", "events", "verdict"} <= found.keys()
    assert found["condition"].keys() == {"mass", "closure"} and found["condition"]["closure"] is None
    assert all(event.keys() == {"time", "kind", "where", "message"} for event in found["events"])
    assert {event["kind"] for event in found["events"]} >= {"half turn"}
    assert found["horizon"] is None and 0.0 < found["stiffness"] < 1.0 and isinstance(found["growth_rate"], float)
    assert found["attitudes"]["b"]["half_turns"] == sum(e["kind"] == "half turn" for e in found["events"])


@pytest.mark.heavy
def test_a_page_with_the_verdict_at_the_top(heun: Heun, folder: Path) -> None:
    (folder / "free.yaml").write_text(SCENE.replace("DUR", "8"))
    done = heun("probe", "free.yaml", "-o", "free.txt")
    text = (folder / "free.txt").read_text()
    assert done.returncode == 0 and not done.stdout
    assert "verdict  no difficulties for heun's default method in this motion" in text
    for heading in ("GROWTH", "STEPS", "CONDITION", "ORIENTATIONS", "EVENTS"):
        assert f"\n{heading}" in text
    assert max(map(len, text.splitlines())) <= 120
    assert heun("probe", "free.yaml", "--set", "bodies.b.mass=2").returncode == 0


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("free.yaml", "--format", "csv"), 2, "--format csv: expected table, json"),
        (("free.yaml", "--time-limit", "-1"), 2, "expected a positive number"),
        (("nowhere.yaml",), 2, "nowhere.yaml"),
        (("free.yaml", "--time-limit", "1e-9"), 4, "time limit"),
    ],
)
def test_refused(heun: Heun, folder: Path, words: tuple[str, ...], code: int, said: str) -> None:
    (folder / "free.yaml").write_text(SCENE.replace("DUR", "8"))
    done = heun("probe", *words)
    assert done.returncode == code and said in done.stderr and not done.stdout


@pytest.mark.parametrize("name", ["chimney", "governor", "percussion", "four_bar"])
def test_of_one_instant_or_driven_what_is_not_told_has_a_reason(heun: Heun, name: str) -> None:
    done = heun("probe", str(Path(__file__).parents[2] / "specs" / f"{name}.yaml"), "--format", "json")
    found = json.loads(done.stdout)
    assert done.returncode == 0 and found["growth_rate"] is None and found["not_told"]["growth_rate"]
