"""A published case is a spec, and a file of the numbers that were printed."""

from __future__ import annotations

from pathlib import Path

from tests.contributing.addition import Addition, heun

LEVER = Addition(
    "A published case",
    {},
    {
        "heuncli/analyses/published/specs/lever.yaml": """\
# A lever on its fulcrum, and what a balance on its end shows.
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {F: [0, 0], B: [3, 0]}}
bodies: {bar: {mass: 6, center: [1, 0], inertia: 1, points: {F: [0, 0], B: [3, 0]}}}
joints:
  fulcrum: {type: ball, from: ground.F, to: bar.F}
  balance: {type: plane, from: ground.B, to: bar.B, normal: [0, 1]}
""",
        "heuncli/analyses/published/numbers/lever.yaml": """\
about: a lever
source: Archimedes, On the Equilibrium of Planes
tables:
  - {where: "book I, 6", kind: printed, of: {joints.balance.force.y: 19.6}}
  - {where: "book I, 7", kind: exact, of: {joints.fulcrum.force.y: 4*9.81}}
""",
    },
)


def test_a_published_case(tmp_path: Path) -> None:
    """It is solved, compared number by number, and its spec written."""
    folder = LEVER.made_in(tmp_path)
    done = heun(folder, "check", "--references", "lever")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 case, 2 numbers, 2 agree" in done.stdout
    assert "# A lever on its fulcrum" in heun(folder, "new", "lever", "-").stdout


def test_its_list() -> None:
    assert LEVER.is_as_listed()
