"""Names of points in expressions: what is read, and what is said of what is none."""

from __future__ import annotations

import pytest

from heuncli.base.errors import Finding
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.quantity import read_condition

POINTS = {"drill": ["top", "bit"], "rod": ["top", "eye"], "bare": [], "ground": ["post", "eye"]}
SCOPE = Scope({"q": 3.0}, {"shaft": "pin", "points": "pin"}, in_time=True, points=POINTS)


@pytest.mark.parametrize(
    ("text", "use"),
    [
        ("points.drill.bit.x", ("points.drill.bit", "x")), ("points.bit.vz", ("points.drill.bit", "vz")),
        ("points.rod.top.y", ("points.rod.top", "y")), ("points.eye.x", ("points.rod.eye", "x")),
        ("points.post.z", ("points.ground.post", "z")), ("points.ground.eye.z", ("points.ground.eye", "z")),
        ("points.angle", ("points", "angle")),  # of a joint that is called so
    ],
)  # fmt: skip
def test_what_it_names(text: str, use: tuple[str, str]) -> None:
    found = compile_expression(f"q*{text} + 1", SCOPE)
    assert found.uses == (use,)
    assert found.value(0.0, [2.0]) == 7.0


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("points.dril.bit.x", "unknown-body", "did you mean drill?"),
        ("points.drill.bitt.x", "unknown-point", "did you mean bit?"),
        ("points.bitt.x", "unknown-point", "did you mean bit?"),
        ("points.top.x", "unknown-point", "name one: points.drill.top, points.rod.top"),
        ("points.drill.x", "unknown-point", "name a point of it: points.drill.top, points.drill.bit"),
        ("points.bare.x", "unknown-point", "bare is a body; bodies: bare: has no points"),
        ("points.drill.bit.w", "unknown-coordinate", "points.BODY.POINT.x"),
        ("points.drill.bit.position.x", "unknown-coordinate", "write points.drill.bit.x"),
        ("points.drill.bit.velocity.z", "unknown-coordinate", "write points.drill.bit.vz"),
        ("points.drill.bit", "unknown-coordinate", "points.BODY.POINT.x"),
        ("drill.bit.x", "unknown-name", "a point is points.drill.bit.x"),
    ],
)  # fmt: skip
def test_what_is_no_point(text: str, code: str, told: str) -> None:
    with pytest.raises(Finding) as caught:
        compile_expression(text, SCOPE)
    assert caught.value.code == code
    assert told in f"{caught.value.message.rpartition(': ')[2]}; {caught.value.hint}"


def test_not_before_the_run() -> None:
    with pytest.raises(Finding) as caught:
        compile_expression("2*points.bit.x", Scope(points=POINTS))
    assert caught.value.code == "not-in-time"


def test_their_dimensions() -> None:
    assert read_condition("points.bit.x < 20 mm", SCOPE).is_truth
    assert read_condition("points.bit.vx < 20 mm/s", SCOPE).is_truth
    for text in ("points.bit.vx < 20 mm", "points.bit.x > 3 deg", "points.bit.x - 1 s > 0"):
        with pytest.raises(Finding) as caught:
            read_condition(text, SCOPE)
        assert caught.value.code == "wrong-dimension"
