"""One instant, one place, one direction, or two."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.errors import Finding
from heuncli.loads.kinetostatics.auto_properties import CutForm, combine_rectangles, find_cut_properties
from heuncli.results.cut_rows import find_cut_rows
from heuncli.results.results import Results
from heuncli.scene.file_format.models import Shape
from heuncli.scene.meshes.reading import read_closed_mesh
from heuncli.scene.shapes.composite_solid import CompositeSolid, make_composite_solid
from heuncli.scene.shapes.figures import RectangleFigure
from heuncli.scene.shapes.section_axes import find_nearest_axis
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import WEIGHT, bar, read, verdict
from tests.shared import triangles
from tests.shared.scenes import near, study


def along_the_normal(x: float) -> str:
    section = f"{{body: bar, at: [0, 0, -0.3], normal: [0, 0, 1], first_axis: [{x!r}, 0, 1]}}"
    return read(bar(", piece: {mass: 0.7, center: [0, 0, -0.65], inertia: [1, 1, 1]}", f"sections: {{s: {section}}}"))


def tilted(x: float) -> str:
    text = bar(f", orientation: {{axis: [1, 0, 0], angle: {2 * math.asin(math.sqrt(x / 2))!r}}}", kind="pin")
    return read(text.replace("gravity: [0, 0, -9.81]", "space: planar"))


def expected_at(x: float) -> str:
    expect = f"expect: [{{of: joints.pivot.force.z, at: {0.5 + x!r}, is: 9.81}}]"
    return read(bar(tail=f"analysis: {{duration: 1, samples: 3}}\n{expect}"))


def needs_side(x: float) -> str:
    """A cut through a bar of 1 m, x off the place of a load."""
    push = f"forces: {{f: {{type: force, on: {{body: bar, at: [0, 0, {-0.3 - x!r}]}}, vector: [0, 1, 0]}}}}"
    section = "sections: {s: {body: bar, at: [0, 0, -0.3], normal: [0, 0, -1]}}"
    text = bar(tail=f"{push}\n{section}")
    solid = "shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 10 mm, mass: 1}]"
    text = text.replace("mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001]", solid)

    def right(found: Results) -> None:
        near(found.sections["s"]["N"][0], 0.7 * WEIGHT, WEIGHT)

    return verdict(text, right)


def beside_a_cut(x: float) -> str:
    """A place x of its length off the middle of a run of three cuts."""
    try:
        return f"row {find_cut_rows(f'@{0.5 + x!r}', np.array([0.0, 0.5, 1.0]), None)[0]}"
    except Finding as finding:
        return f"refused: {finding.code}"


def two_legs(x: float) -> str:
    """A cut through two legs, 0.1 m square, x of the sum of their half diagonals apart."""
    half = 0.05 + 0.5 * x * 0.1 * math.sqrt(2)
    legs = ", ".join(f"{{type: box, center: [{s * half!r}, 0, -0.5], size: [0.1, 0.1, 1], mass: 0.5}}" for s in (-1, 1))
    text = bar(tail="sections: {s: {body: bar, at: [0, 0, -0.3], normal: [0, 0, -1]}}")
    text = text.replace("mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001]", f"shapes: [{legs}]")
    return verdict(text, lambda found: near(found.sections["s"]["N"][0], 0.7 * WEIGHT, WEIGHT)).split(" in ")[0]


def one_place(x: float) -> str:
    """A body on a ball 1 m off the origin, and its centre 3/4 x beyond: a scene of the size x, or of 1 m."""
    body = f"{{mass: 1, center: [{0.75 * x!r}, 0, 0], inertia: [0, 0, 0], points: {{p: [0, 0, 0]}}}}"
    text = f"heun: 1\nground: {{points: {{O: [1, 0, 0]}}}}\nbodies: {{b: {body}}}\n"
    found = study(text + "joints: {j: {type: ball, from: ground.O, to: b.p}}").setup.scene.layout.size
    return "1 m" if found == 1.0 else "its extent"


def equal(x: float) -> str:
    # y is the nearest to the normal; of x and y alike, x is
    n = np.array([0.6, 0.6 + x, 0.4])
    return "xyz"[find_nearest_axis(n / math.sqrt(n @ n))]


def askew(x: float) -> str:
    """A web and two flanges, shifted either way until I12 is x of √(I1 I2)."""
    I1, I2 = 2 * 2.0 * 1.0**3 / 12 + 2 * 2.0 * 1.5**2 + 1.0 * 2.0**3 / 12, 2 * 2.0**3 / 12 + 2.0 / 12
    shift = x * math.sqrt(I1 * I2) / (2 * 2.0 * 1.5)
    met, at = np.array([True]), [[0.0, 0.0], [shift, 1.5], [-shift, -1.5]]
    parts = [
        RectangleFigure(met, np.array([[*place, 0.0]]), width, height)
        for place, width, height in zip(at, (1.0, 2.0, 2.0), (2.0, 1.0, 1.0), strict=True)
    ]
    zero, ex, ez = np.zeros(1), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    found = combine_rectangles(parts, 0, CutForm(CompositeSolid((), 1e-15), ez, ex, zero, zero), 1e-12)
    return "refused" if isinstance(found, str) else "taken"


def open_by(x: float) -> str:
    """A box of side 1 from -1 to 0, one corner of a triangle off by x of the largest coordinate."""
    off = triangles.box([-1, -1, -1], [0, 0, 0])
    off[0, 0, 0] += x
    try:
        mesh = read_closed_mesh(triangles.obj(off).encode(), "a.obj")
    except Finding as finding:
        return f"refused: {finding.code}"
    near(mesh.volume, 1.0, 1.0, max(x, 1e-15))
    return "one corner"


def outline_of(corners: list[tuple[float, float]]) -> str:
    """The cut through a prism of four corners, about e1 along y."""
    prism = triangles.prism(np.array(corners), [(0, 1, 2), (0, 2, 3)], 1.0)
    surface = read_closed_mesh(triangles.obj(prism).encode(), "a.obj")
    I = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    body = make_composite_solid([Shape("mesh", density=1.0, mesh=surface, scale=1.0, at=(0.0, 0.0, 0.0), rotation=I)])
    at = CutForm(body, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([0.5]), np.zeros(1))
    found = find_cut_properties(at)
    if not found.missing:
        near(found.groups[0].values["area"], 2.0, 1.0)
    return "refused" if found.missing else "taken"


def sheared(x: float) -> str:
    """A parallelogram of base 2 and height 1: I12 = s b h^3/12 of I1 = b h^3/12, I2 = h b^3/12 (1 + ...)."""
    s = 2.0 * x
    return outline_of([(-1 - s / 2, -0.5), (1 - s / 2, -0.5), (1 + s / 2, 0.5), (-1 + s / 2, 0.5)])


def tapered(x: float) -> str:
    """A trapezium of base 2 and height 1, its sides 2 (1 + t) and 2 (1 - t): sum x x y = -2 t h^2 b^3/8/30 ..."""
    t = lean(x)
    return outline_of([(-1 - t, -0.5), (1 + t, -0.5), (1 - t, 0.5), (-1 + t, 0.5)])


def lean(x: float) -> float:
    """The t for which the largest third moment of that trapezium is x of its area times its half width cubed.

    About its middle sum y y y, x x y are odd in t, and small t leaves sum x x y = -(2/3) 3 t/6 of the sides' moments:
    int (2/3) (1 - 2 t y)^3 y dy = -t/3, less what the centroid moves by, -t/6, times sum x x = 2/3.
    """
    return x * 2.0 / abs(-1.0 / 3.0 + 2.0 / 3.0 / 6.0)


PART = Part(
    ("same instant, same place, same direction",),
    rows=(
        Row("SAME_INSTANT", expected_at, "fine", "refused: expect-instants"),
        Row("PARALLEL", along_the_normal, "refused: first-axis", "fine"),
        Row("UPRIGHT", tilted, "fine", "refused: not-planar"),
        Row("EQUAL_COMPONENTS", equal, "x", "y"),
        Row("PRINCIPAL", askew, "taken", "refused"),
        Row("MESH_DIGITS", open_by, "one corner", "refused: open-mesh"),
        Row("OUTLINE_PRINCIPAL", sheared, "taken", "refused"),
        Row("OUTLINE_SYMMETRIC", tapered, "taken", "refused"),
        Row("IN_PLANE", needs_side, "refused: needs-side", "fine"),
        Row("SAME_CUT", beside_a_cut, "row 1", "refused: unknown-path"),
        Row("OUTLINES_APART", two_legs, "fine", "warned: sections.s: the plane meets the body bar"),
        Row("ONE_PLACE", one_place, "1 m", "its extent"),
    ),
    exempt={
        "LEAST_EXTENT": "what IN_PLANE is measured by where all lies in the origin",
        "OFF_AXIS": "two formulas for the same piece of a body of revolution",
        "SIDE_BY_SIDE": "ends a search at a jump that nobody told of",
    },
    wanted={
        "TOUCHING": "whether two outlines without extent are one",
    },
)
