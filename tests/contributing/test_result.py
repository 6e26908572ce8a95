"""A result is a row of the schema and a line where its block is made."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.contributing.addition import Addition, after, answers, heun

CENTER_SPEED = Addition(
    "A result",
    {
        "heuncli/results/results_schema.py": (
            after(""" vector("center_acceleration", "m/s²")),
""", """    *rows("bodies.BODY", "of the centre of mass, without its direction", scalar("center_speed", "m/s")),
"""),
        ),
        "heuncli/study/compose/blocks.py": (
            after("""        "center_velocity": states.v_centre[:, i],
""", """        "center_speed": np.linalg.norm(states.v_centre[:, i], axis=1),
"""),
        ),
    },
)  # fmt: skip
SCENE = """\
heun: 1
gravity: [0, 0, -10]
bodies: {a: {mass: 4, center: [0, 0, 0], inertia: [1, 1, 1], velocity: [3, 4, 0]}}
analysis: {times: [0, 1.2]}
"""


def test_a_result(tmp_path: Path) -> None:
    """It is measured between the samples, too, and stands in JSON and in CSV with its unit."""
    folder = CENTER_SPEED.made_in(tmp_path)
    found = answers(folder, SCENE, ["final bodies.a.center_speed", "min bodies.a.center_speed"])
    assert found == pytest.approx([13.0, 5.0], rel=1e-9)
    block = json.loads(heun(folder, "run", "-", "--format", "json", text=SCENE).stdout)["bodies"]["a"]
    assert block["center_speed"] == pytest.approx([5.0, 13.0])
    assert "bodies,a,center_speed,,m/s," in heun(folder, "run", "-", "--format", "csv", text=SCENE).stdout
    assert "center_speed" in heun(folder, "run", "-", "--measure", "final bodies.a.center_sped", text=SCENE).stderr


def test_its_list() -> None:
    assert CENTER_SPEED.is_as_listed()
