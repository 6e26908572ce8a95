"""The slider-crank of manual/theory.md, "Closed cases" 12, as text: joints as often drawn, or determinate."""

from __future__ import annotations

R, L = 0.1, 0.3  # crank and rod [m]
CRANK, ROD, SLIDER = 1.0, 0.8, 1.5  # [kg], crank and rod uniform and thin
# As everybody draws it, three loads held twice; and as it should be drawn.
JOINTS = {
    "four pins": ("{type: pin, axis: [0, 0, 1]", "{type: pin, axis: [0, 0, 1]"),
    "determinate": ("{type: ball", "{type: universal, axis: [0, 0, 1], to_axis: [0, 1, 0]"),
}


def slider_crank(told: str, phi: str, more: str) -> str:
    """Crank about z from x, guide along x; `phi` an angle held at the start or driven."""
    big_end, wrist = JOINTS[told]
    return f"""
heun: 1
parameters: {{r: {R}, l: {L}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank:
    shapes: [{{type: rod, from: [0, 0, 0], to: [r, 0, 0], mass: {CRANK}}}]
    points: {{O: [0, 0, 0], A: [r, 0, 0]}}
  rod:
    shapes: [{{type: rod, from: [0, 0, 0], to: [l, 0, 0], mass: {ROD}}}]
    points: {{A: [0, 0, 0], B: [l, 0, 0]}}
  slider:
    shapes: [{{type: sphere, center: [0, 0, 0], radius: 0.01, mass: {SLIDER}}}]
    points: {{B: [0, 0, 0]}}
    near: {{position: [r + l, 0, 0]}}
joints:
  shaft: {{type: pin, from: ground.O, to: crank.O, axis: [0, 0, 1]{phi}}}
  big_end: {big_end}, from: crank.A, to: rod.A}}
  wrist: {wrist}, from: rod.B, to: slider.B}}
  guide: {{type: slide, axis: [1, 0, 0], from: ground.O, to: slider.B}}
{more}"""
