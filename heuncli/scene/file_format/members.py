"""Members as a spec gives them: by measures or by name, the same at both ends or tapered, and boxes with a wall."""

from __future__ import annotations

import math

from heuncli.base.errors import Finding
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.models import Member, Properties, Vec
from heuncli.scene.file_format.profiles import (
    Family,
    Measures,
    NamedProfile,
    check_measures,
    compute_area,
    find_profile,
)
from heuncli.scene.file_format.rotations import IDENTITY
from heuncli.scene.file_format.semantics import orientation_matrix

MEASURED: tuple[Family, ...] = ("I", "C", "L", "T")
END_KEYS = ("height", "width", "web", "flange")


def is_member(shape: fs.ShapeEntry) -> bool:
    """Whether a shape is a member, or a circular tube by its name."""
    if isinstance(shape, fs.BoxShape):
        return shape.wall is not None
    return isinstance(shape, fs.MemberShape | fs.ProfileShape)


def find_ends(shape: fs.ShapeEntry) -> tuple[Vec, Vec]:
    """Return the two ends of a member's axis; of a box, along its longest edges."""
    if not isinstance(shape, fs.BoxShape):
        assert isinstance(shape, fs.MemberShape | fs.ProfileShape)
        return shape.from_, shape.to
    axis, _ = _find_box_axes(shape)
    half, c = 0.5 * max(shape.size), shape.center
    return (
        (c[0] - half * axis[0], c[1] - half * axis[1], c[2] - half * axis[2]),
        (c[0] + half * axis[0], c[1] + half * axis[1], c[2] + half * axis[2]),
    )


def find_member(shape: fs.ShapeEntry) -> Member | NamedProfile:
    """Return the member, or the circular tube. Raises Finding [unknown-profile] or [member-form]."""
    if isinstance(shape, fs.ProfileShape):
        return _find_named_member(shape)
    if isinstance(shape, fs.MemberShape):
        family = next(known for known in MEASURED if known == shape.type)  # type: ignore[attr-defined]
        radii = (shape.radius or 0.0, shape.toe_radius or 0.0)
        first = Measures(shape.width, shape.height, shape.web, shape.flange, *radii)
        changes = {key: to for key in END_KEYS if (to := getattr(shape, f"to_{key}")) is not None}
        last = first._replace(**changes)
        for measures in (first, last) if changes else (first,):
            check_measures(family, measures)
        return Member(family, first, last, shape.first_axis)
    assert isinstance(shape, fs.BoxShape)
    assert shape.wall is not None
    sizes = sorted(shape.size)
    if sizes[1] == sizes[2]:
        message = f"a box with a wall is open at the ends of its longest edges, but two sizes are {sizes[2]:g} m"
        raise Finding("member-form", message, "use properties of the section, or make one edge longer")
    _, width_axis = _find_box_axes(shape)
    along = shape.size.index(sizes[2])
    b, h = shape.size[(along + 1) % 3], shape.size[(along + 2) % 3]
    measures = Measures(b, h, shape.wall, shape.wall)
    check_measures("box", measures)
    return Member("box", measures, measures, width_axis)


def _find_box_axes(shape: fs.BoxShape) -> tuple[Vec, Vec]:
    """Return the direction of a box's longest edges, and of those that follow them (x, y, z, x): its width."""
    matrix = orientation_matrix(shape.orientation) if shape.orientation is not None else IDENTITY
    i = shape.size.index(max(shape.size))
    j = (i + 1) % 3
    return (matrix[0][i], matrix[1][i], matrix[2][i]), (matrix[0][j], matrix[1][j], matrix[2][j])


def _find_named_member(shape: fs.ProfileShape) -> Member | NamedProfile:
    first = find_profile(shape.profile)
    last = first if shape.to_profile is None else find_profile(shape.to_profile)
    if first.measures is None or last.measures is None:
        if last is not first:
            hint = "taper between two profiles of one family; for a conical tube use properties of the section"
            raise Finding("member-form", "a circular tube cannot taper", hint)
        return first
    if first.family != last.family or first.measures.slope != last.measures.slope:
        message = f"{shape.profile} cannot taper to {shape.to_profile}: they are not of one form"
        raise Finding("member-form", message, "give two profiles of one family, such as IPE 300 and IPE 200")
    assert first.family != "tube"
    return Member(first.family, first.measures, last.measures, shape.first_axis)


def find_section_measures(entry: f.PropertiesEntry) -> Properties | None:
    """Return the properties that are given as a member, or None. Raises Finding as `find_member`."""
    if entry.profile is not None:
        profile = find_profile(entry.profile)
        if profile.measures is None:
            return Properties("tube", {"radius": profile.radius, "inner_radius": profile.inner_radius})
        assert profile.family != "tube"
        return Properties(profile.family, profile.measures._asdict())
    if entry.box is not None:
        b = entry.box
        measures = Measures(b.width, b.height, b.wall, b.wall, b.radius, max(b.radius - b.wall, 0.0))
        check_measures("box", measures)
        return Properties("box", measures._asdict())
    for family in MEASURED:
        if (given := getattr(entry, family)) is not None:
            measures = Measures(**vars(given))
            check_measures(family, measures)
            return Properties(family, measures._asdict())
    return None


def compute_mean_area(member: Member | NamedProfile) -> float:
    """Return the volume of a member over its length [m2]; the area of a tapered one is quadratic along it."""
    if isinstance(member, NamedProfile):
        return math.pi * (member.radius - member.inner_radius) * (member.radius + member.inner_radius)
    first, last = member.start, member.end
    middle = Measures(*(0.5 * (a + b) for a, b in zip(first, last, strict=True)))
    areas = [compute_area(member.family, measures) for measures in (first, middle, last)]
    return (areas[0] + 4.0 * areas[1] + areas[2]) / 6.0
