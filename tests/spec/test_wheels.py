"""A wheel named by its body and the pin in which it turns is that of its centre and axis; what is said of others."""

from __future__ import annotations

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load

CART = """\
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  cart: {{mass: 1, center: [0, 0, 0.1], inertia: [0.01, 0.01, 0.01], points: {{a: [0, 0, 0.1]}}}}
  disc: {{mass: 1, center: [0, 0, 0], inertia: [0.01, 0.02, 0.01], orientation: {{axis: [0, 0, 1], angle: 90 deg}},
         points: {{c: [0, 0, 0]}}}}
joints:
  rail: {{type: slide, from: {{body: ground, at: [0, 0, 0.1]}}, to: cart.a, axis: [1, 0, 0]}}
  turns: {{type: {joint}}}
rolling:
  rim: {{{wheel}, radius: 0.1, on: ground.O, normal: [0, 0, 1]}}
analysis: {{type: state}}
"""
PIN = "pin, from: cart.a, to: disc.c, axis: [0, 1, 0]"
TURNED = PIN + ", to_axis: [1, 0, 0]"
BACK = "cylinder, from: disc.c, to: cart.a, axis: [1, 0, 0], to_axis: [0, 1, 0]"


@pytest.mark.parametrize(("joint", "axis"), [(PIN, "[0, 1, 0]"), (TURNED, "[1, 0, 0]"), (BACK, "[1, 0, 0]")])
def test_by_its_pin_or_by_its_point(joint: str, axis: str) -> None:
    """The axis in the wheel's own axes is that of the pin on the wheel's side, whichever side that is."""
    by_pin = load("cart.yaml", CART.format(joint=joint, wheel="body: disc, axle: turns"))
    by_point = load("cart.yaml", CART.format(joint=joint, wheel=f"wheel: disc.c, axis: {axis}"))
    assert by_pin.rolling == by_point.rolling


@pytest.mark.parametrize(
    ("wheel", "joint", "place", "words"),
    [
        ("axle: turns", PIN, "rolling.rim", "'body' is missing, but 'axle' is given"),
        ("body: disc", PIN, "rolling.rim", "'axle' is missing, but 'body' is given"),
        ("friction: 0.5", PIN, "rolling.rim", "'wheel' is missing"),
        ("body: disc, axle: turn", PIN, "rolling.rim.axle", "'turn' is not a joint"),
        ("body: disk, axle: turns", PIN, "rolling.rim.body", "'disk' is not a body"),
        ("body: ground, axle: turns", PIN, "rolling.rim.body", "ground is not at the joint turns"),
        ("body: disc, axle: turns", "ball, from: cart.a, to: disc.c", "rolling.rim.axle", "is of type ball"),
        ("body: disc, axle: turns, axis: [0, 1, 0]", PIN, "rolling.rim.axis", "axle and axis are both given"),
        ("wheel: disc.c, axis: [0, 1, 0], axle: turns", PIN, "rolling.rim.axle", "wheel and axle are both given"),
    ],
)
def test_what_is_no_wheel_is_said_at_its_place(wheel: str, joint: str, place: str, words: str) -> None:
    with pytest.raises(SpecError) as raised:
        load("cart.yaml", CART.format(joint=joint, wheel=wheel))
    assert [
        str(problem) for problem in raised.value.problems if f": {place}: " in str(problem) and words in str(problem)
    ]
