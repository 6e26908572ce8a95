"""The measures of members: their names, the tables of rolled profiles, and what makes a section impossible.

A member is I, C (web to the left, open to the right), L (heel at the lower left), T (flange on top) or box, width to
the right, height up. The tables have the nominal measures of EN 10365 (IPE, HEA, HEB, HEM) and of DIN 1026-1 (UPN), in
mm; all other numbers follow from them (scene/shapes/member_section.py). Hollow sections have their measures in their
names, and the corner radii by which EN 10210-2 (hot finished) and EN 10219-2 (cold formed, CF before the name)
calculate: outer and inner ones over the wall t are 1.5 and 1; cold formed 2 and 1 up to t = 6 mm, 2.5 and 1.5 up to 10
mm, 3 and 2 beyond.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Literal, get_args

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar

Family = Literal["I", "C", "L", "T", "box"]
FAMILIES: tuple[Family, ...] = get_args(Family)


class Measures(NamedTuple):
    """The measures of a member [m].

    width, height: over all
    web: thickness of the web, or of an L's leg along the height; of a box of its sides along the height
    flange: thickness of the flanges, in the middle of their width, or of an L's leg along the width
    radius: of the fillets between web and flange; of a box outside
    toe_radius: at the tips of flanges and legs; of a box inside
    slope: of the inner faces of a C's flanges [1]
    """

    width: float
    height: float
    web: float
    flange: float
    radius: float = 0.0
    toe_radius: float = 0.0
    slope: float = 0.0


class NamedProfile(NamedTuple):
    """A profile with a name: a member of its measures, or a circular tube [m]."""

    family: Literal["I", "C", "box", "tube"]
    measures: Measures | None
    radius: float = 0.0
    inner_radius: float = 0.0


# the corners of the outlines, by name, and the middle of the web: where stresses are reported
STRESS_POINTS = (
    "bottom_left", "bottom_right", "top_right", "top_left", "left_tip", "right_tip", "heel", "right_tip_inside",
    "top_tip_inside", "top_tip", "web",
)  # fmt: skip
# name: height, width, web, flange, radius [mm]
I_PROFILES = """
IPE 80 46 3.8 5.2 5; 100 55 4.1 5.7 7; 120 64 4.4 6.3 7; 140 73 4.7 6.9 7; 160 82 5 7.4 9; 180 91 5.3 8 9;
    200 100 5.6 8.5 12; 220 110 5.9 9.2 12; 240 120 6.2 9.8 15; 270 135 6.6 10.2 15; 300 150 7.1 10.7 15;
    330 160 7.5 11.5 18; 360 170 8 12.7 18; 400 180 8.6 13.5 21; 450 190 9.4 14.6 21; 500 200 10.2 16 21;
    550 210 11.1 17.2 24; 600 220 12 19 24
HEA 96 100 5 8 12; 114 120 5 8 12; 133 140 5.5 8.5 12; 152 160 6 9 15; 171 180 6 9.5 15; 190 200 6.5 10 18;
    210 220 7 11 18; 230 240 7.5 12 21; 250 260 7.5 12.5 24; 270 280 8 13 24; 290 300 8.5 14 27; 310 300 9 15.5 27;
    330 300 9.5 16.5 27; 350 300 10 17.5 27; 390 300 11 19 27; 440 300 11.5 21 27; 490 300 12 23 27;
    540 300 12.5 24 27; 590 300 13 25 27; 640 300 13.5 26 27; 690 300 14.5 27 27; 790 300 15 28 30; 890 300 16 30 30;
    990 300 16.5 31 30
HEB 100 100 6 10 12; 120 120 6.5 11 12; 140 140 7 12 12; 160 160 8 13 15; 180 180 8.5 14 15; 200 200 9 15 18;
    220 220 9.5 16 18; 240 240 10 17 21; 260 260 10 17.5 24; 280 280 10.5 18 24; 300 300 11 19 27; 320 300 11.5 20.5 27;
    340 300 12 21.5 27; 360 300 12.5 22.5 27; 400 300 13.5 24 27; 450 300 14 26 27; 500 300 14.5 28 27;
    550 300 15 29 27; 600 300 15.5 30 27; 650 300 16 31 27; 700 300 17 32 27; 800 300 17.5 33 30; 900 300 18.5 35 30;
    1000 300 19 36 30
HEM 120 106 12 20 12; 140 126 12.5 21 12; 160 146 13 22 12; 180 166 14 23 15; 200 186 14.5 24 15; 220 206 15 25 18;
    240 226 15.5 26 18; 270 248 18 32 21; 290 268 18 32.5 24; 310 288 18.5 33 24; 340 310 21 39 27; 359 309 21 40 27;
    377 309 21 40 27; 395 308 21 40 27; 432 307 21 40 27; 478 307 21 40 27; 524 306 21 40 27; 572 306 21 40 27;
    620 305 21 40 27; 668 305 21 40 27; 716 304 21 40 27; 814 303 21 40 30; 910 302 21 40 30; 1008 302 21 40 30
"""
HE_SIZES = (
    100, 120, 140, 160, 180, 200, 220, 240, 260, 280, 300, 320, 340, 360, 400, 450, 500, 550, 600, 650, 700, 800, 900,
    1000,
)  # fmt: skip
# name: height, width, web, flange and radius, toe radius [mm]. The flanges' inner faces slope by 8 %, the flange's
# thickness is that in the middle of its width; above 300 mm they slope by 5 %, and it is in the middle between web and
# tip.
UPN_PROFILES = """
80 45 6 8 4; 100 50 6 8.5 4.5; 120 55 7 9 4.5; 140 60 7 10 5; 160 65 7.5 10.5 5.5; 180 70 8 11 5.5; 200 75 8.5 11.5 6;
220 80 9 12.5 6.5; 240 85 9.5 13 6.5; 260 90 10 14 7; 280 95 10 15 7.5; 300 100 10 16 8; 320 100 14 17.5 8.75;
350 100 14 16 8; 380 102 13.5 16 8; 400 110 14 18 9
"""
LAST_STEEP_CHANNEL = 300  # [mm]
STEEP, FLAT = 0.08, 0.05
MM = 1e-3
HOLLOW = re.compile(r"(CF)?(RHS|SHS|CHS)(\d+(?:\.\d+)?)((?:X\d+(?:\.\d+)?)+)")
H_BEAM = re.compile(r"HE(\d+)([ABM])")
KNOWN = "IPE, HEA, HEB, HEM and UPN by size, such as IPE 200; RHS 100x50x4, SHS 80x5, CHS 60.3x3.2"


def _read_rows(text: str) -> list[list[float]]:
    """Read rows of numbers."""
    return [[float(number) for number in row.split()] for row in text.split(";")]


@cache
def read_tables() -> dict[str, NamedProfile]:
    """Read the tables: the profiles by their names, such as IPE 200."""
    profiles: dict[str, NamedProfile] = {}
    for series in re.split(r"\n(?=[A-Z])", I_PROFILES.strip()):
        name, _, rows = series.partition(" ")
        for i, (height, width, web, flange, radius) in enumerate(_read_rows(rows)):
            size = f"{height:g}" if name == "IPE" else HE_SIZES[i]
            measures = Measures(width * MM, height * MM, web * MM, flange * MM, radius * MM)
            profiles[f"{name} {size}"] = NamedProfile("I", measures)
    for height, width, web, flange, toe in _read_rows(UPN_PROFILES):
        slope, thickness = STEEP, flange
        if height > LAST_STEEP_CHANNEL:
            slope, thickness = FLAT, flange + 0.5 * FLAT * web
        measures = Measures(width * MM, height * MM, web * MM, thickness * MM, flange * MM, toe * MM, slope)
        profiles[f"UPN {height:g}"] = NamedProfile("C", measures)
    return profiles


def find_profile(name: str) -> NamedProfile:
    """Find the profile of a name, in any case and with or without blanks. Raises Finding [unknown-profile]."""
    word = re.sub(r"[\s_]+", "", name).upper().replace("×", "X").replace(",", ".")
    h_beam, hollow = H_BEAM.fullmatch(word), HOLLOW.fullmatch(word)
    if h_beam is not None:
        word = f"HE{h_beam[2]}{h_beam[1]}"
    found = {known.replace(" ", ""): profile for known, profile in read_tables().items()}.get(word)
    if found is not None:
        return found
    if hollow is not None:
        sizes = [float(hollow[3]), *map(float, hollow[4][1:].split("X"))]
        return _make_hollow(name, hollow[2], sizes, is_cold=hollow[1] is not None)
    raise Finding("unknown-profile", f"'{name}' is not a known profile", _suggest_profiles(word))


def _suggest_profiles(word: str) -> str:
    """Suggest the nearest sizes of a series, or else a similar name."""
    sized = re.fullmatch(r"([A-Z]+)(\d+)", word)
    series = [known for known in read_tables() if sized is not None and known.split()[0] == sized[1]]
    if sized is None or not series:
        similar = find_similar(word, [*read_tables()])
        return f"known: {KNOWN}" if similar is None else f"did you mean {similar}?"
    nearest = sorted(series, key=lambda known: abs(int(known.split()[1]) - int(sized[2])))[:2]
    return f"the nearest are {' and '.join(nearest)}"


def _make_hollow(name: str, kind: str, sizes: list[float], is_cold: bool) -> NamedProfile:
    """Make a hollow section from the numbers in its name [mm]. Raises Finding [unknown-profile]."""
    if kind == "SHS" and len(sizes) == 2:
        sizes = [sizes[0], *sizes]
    if len(sizes) != (2 if kind == "CHS" else 3) or (kind == "SHS" and sizes[0] != sizes[1]):
        form = {"CHS": "CHS 60.3x3.2, diameter and wall", "SHS": "SHS 80x5, side and wall"}
        hint = f"write {form.get(kind, 'RHS 100x50x4, height, width and wall')}, in mm"
        raise Finding("unknown-profile", f"'{name}' has not the measures of its kind", hint)
    wall = sizes[-1]
    if kind == "CHS":
        if not 0.0 < 2.0 * wall < sizes[0]:
            raise make_wall_error(wall * MM, sizes[0] * MM, "diameter")
        return NamedProfile("tube", None, 0.5 * sizes[0] * MM, (0.5 * sizes[0] - wall) * MM)
    outer, inner = (1.5, 1.0) if not is_cold else (2.0, 1.0) if wall <= 6.0 else (2.5, 1.5) if wall <= 10.0 else (3, 2)
    t = wall * MM
    measures = Measures(sizes[1] * MM, sizes[0] * MM, t, t, outer * t, inner * t)
    check_measures("box", measures)
    return NamedProfile("box", measures)


def make_wall_error(wall: float, size: float, name: str) -> Finding:
    """Make the error for walls that leave nothing between them."""
    message = f"a wall of {wall:g} m leaves nothing of a {name} of {size:g} m between its two sides"
    return Finding("member-form", message, "walls are thinner than half of the section")


def check_measures(family: Family, m: Measures) -> None:
    """Check that a member can have these measures. Raises Finding [member-form]."""
    for key in ("width", "height", "web", "flange"):
        if getattr(m, key) <= 0.0:
            raise Finding("member-form", f"{key} must be greater than 0, but is {getattr(m, key):g}", "in m, or 5 mm")
    for key in ("radius", "toe_radius", "slope"):
        if getattr(m, key) < 0.0:
            raise Finding(
                "member-form", f"{key} must not be negative, but is {getattr(m, key):g}", "leave it out for 0"
            )
    webs, flanges = (2 if family == "box" else 1), (1 if family in ("L", "T") else 2)
    for count, wall, size, name in ((webs, m.web, m.width, "width"), (flanges, m.flange, m.height, "height")):
        if count * wall >= size:
            if count == 2:
                raise make_wall_error(wall, size, name)
            message = f"a wall of {wall:g} m is not less than the {name} of {size:g} m"
            raise Finding("member-form", message, f"give a {name} larger than the wall")
    for key, limit in _radius_limits(family, m):
        if getattr(m, key) > limit:
            message = f"{key} {getattr(m, key):g} m does not fit: there is room for {max(limit, 0.0):.6g} m"
            raise Finding("member-form", message, "give a smaller radius, or leave it out")


def _radius_limits(family: Family, m: Measures) -> tuple[tuple[str, float], tuple[str, float]]:
    """Return the largest possible radii by their keys [m]."""
    if family == "box":
        # where the arcs of a corner are closest, on its diagonal, the wall has t - (1 - sqrt(1/2)) (R - r)
        thickest = m.toe_radius + min(m.web, m.flange) / (1.0 - math.sqrt(0.5))
        clear = min(m.width - 2.0 * m.web, m.height - 2.0 * m.flange)
        return ("radius", min(thickest, 0.5 * m.width, 0.5 * m.height)), ("toe_radius", 0.5 * clear)
    overhang = m.width - m.web if family in ("C", "L") else 0.5 * (m.width - m.web)
    root, tip = m.flange + m.slope * (0.5 * m.width - m.web), m.flange - 0.5 * m.slope * m.width
    rise = m.height - root if family in ("L", "T") else 0.5 * m.height - root
    toe_on_web = m.toe_radius if family == "L" else 0.0
    return (
        ("radius", min(overhang - m.toe_radius, rise - toe_on_web)),
        ("toe_radius", min(tip, m.web) if family == "L" else tip),
    )


def compute_area(family: Family, m: Measures) -> float:
    """Return the area of a member's cross-section [m2]: of its walls, with their fillets and rounded tips."""
    b, h, t, f = m.width, m.height, m.web, m.flange
    if family == "box":
        hole = (b - 2.0 * t) * (h - 2.0 * f) - 4.0 * _rounding_area(m.toe_radius)
        return b * h - 4.0 * _rounding_area(m.radius) - hole
    if family == "C":
        turn = 0.5 * math.pi - math.atan(m.slope)
        corners = _rounding_area(m.radius, turn) - _rounding_area(m.toe_radius, turn)
        return t * h + 2.0 * (b - t) * (f - 0.5 * m.slope * t) + 2.0 * corners
    fillets, toes, flanges = {"I": (4, 4, 2), "T": (2, 2, 1), "L": (1, 2, 1)}[family]
    corners = fillets * _rounding_area(m.radius) - toes * _rounding_area(m.toe_radius)
    return t * h + flanges * (b - t) * f + corners


def _rounding_area(radius: float, turn: float = 0.5 * math.pi) -> float:
    """Return the area between a corner of this turn [rad] and the arc that rounds it."""
    return radius * radius * (math.tan(0.5 * turn) - 0.5 * turn)
