"""Rules about sections: one cut or a series of cuts, in a body with known mass distribution, with properties in one
form; and about sensors, each of which reads the load of a cut or the reaction of a joint.
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.spelling import suggest
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.rotations import are_parallel
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.semantics import find_point

MAX_PLAUSIBLE_STRENGTH = 1e4  # [MPa] a few times the strength of the hardest steel
GENERAL_KEYS = ("area", "I1", "I2", "J", "c1", "c2")
SECTION_SHAPES = ("circle", "tube", "rectangle", "I", "C", "L", "T", "box", "profile")
REDUCED_TO = ("at", "centroid", "line")
MAX_CUTS = 50_000  # in a series: finer than any figure shows, and validate still takes only a second
ADD_DEFLECTION = "add deflection: true"
SHEAR_FACTOR_HINT = "1 is a uniform stress; a rectangle has 1.5, a circle 4/3"


def is_cut_series(section: f.SectionEntry) -> bool:
    """Return whether a section is a series of cuts."""
    return section.from_ is not None or section.to is not None or section.count is not None


@rule("section-form")
def check_section_form(draft: DraftDocument) -> Iterator[Violation]:
    """A cut has at and normal; a series of cuts has from, to and count, and its normal points from one to the other."""
    for name, section in draft.document.sections.items():
        path = ("sections", name)
        single_keys = [key for key in ("at", "normal") if getattr(section, key) is not None]
        series_keys = [
            key
            for key, value in (("from", section.from_), ("to", section.to), ("count", section.count))
            if value is not None
        ]
        if single_keys and series_keys:
            single, series = " and ".join(single_keys), " and ".join(series_keys)
            message = f"{single} (one cut) given together with {series} (a series of cuts)"
            yield Violation(path, message, "the normal of a series of cuts points from `from` to `to`", key=True)
        elif not series_keys and len(single_keys) < 2:
            missing = [key for key in ("at", "normal") if key not in single_keys]
            yield Violation(
                path,
                f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing",
                "a series of cuts has from, to and count instead",
                key=True,
            )
        elif series_keys and len(series_keys) < 3:
            missing = [key for key in ("from", "to", "count") if key not in series_keys]
            hint = "a series of cuts has from, to and count: 21"
            yield Violation(
                path, f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing", hint, key=True
            )
        elif series_keys:
            yield from check_cut_series(draft, name, section)
        if section.reduce_to not in REDUCED_TO and isinstance(section.reduce_to, str) and "." not in section.reduce_to:
            message = f"'{section.reduce_to}' is not a reference point"
            yield Violation(
                (*path, "reduce_to"), message, "known: at, centroid, line, or a point body.point or ground.point"
            )


def check_cut_series(draft: DraftDocument, name: str, section: f.SectionEntry) -> Iterator[Violation]:
    """A series of cuts has two ends, two cuts at least, and takes both sides by itself."""
    path = ("sections", name)
    if section.count is not None and not 2 <= section.count <= MAX_CUTS:
        hint = (
            "for one cut write {body, at, normal}"
            if section.count < 2
            else "extremes are also searched between the cuts"
        )
        yield Violation((*path, "count"), f"a series has 2 to {MAX_CUTS} cuts, not {section.count}", hint)
    body = draft.document.bodies.get(section.body)
    if body is not None:
        ends = [find_point(body, end) for end in (section.from_, section.to)]
        if ends[0] is not None and ends[0] == ends[1]:
            yield Violation(
                (*path, "to"),
                "from and to are the same point",
                "give two points: the normal points from one to the other",
            )
    if section.side is not None:
        yield Violation(
            (*path, "side"), "side given for a series of cuts, which shows both sides", "leave it out", key=True
        )
    if section.piece is not None:
        yield Violation(
            (*path, "piece"),
            "a piece is given for a series of cuts",
            "a series of cuts needs a body with shapes",
            key=True,
        )


@rule("section-matter")
def check_section_matter(draft: DraftDocument) -> Iterator[Violation]:
    """A cut needs shapes, or the piece that it separates, unless the body has no mass."""
    for name, section in draft.document.sections.items():
        body = draft.document.bodies.get(section.body)
        if body is None or body.shapes is not None or section.piece is not None or body.mass == 0.0:
            continue
        if body.piece is None or is_cut_series(section):
            message = f"{section.body} has no shapes: the mass beyond the cut is not known"
            hint = "give the body shapes, for example [{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 2}]" + (
                "" if is_cut_series(section) else ", or give the section a piece: {mass, center, inertia}"
            )
            yield Violation(("sections", name, "body"), message, hint)


@rule("first-axis")
def check_first_axis(draft: DraftDocument) -> Iterator[Violation]:
    """first_axis does not point along the normal."""
    for name, section in draft.document.sections.items():
        normal = section.normal
        body = draft.document.bodies.get(section.body)
        if normal is None and body is not None:
            start, end = find_point(body, section.from_), find_point(body, section.to)
            if start is not None and end is not None:
                normal = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
        if section.first_axis is None or normal is None or not any(normal) or not any(section.first_axis):
            continue
        if are_parallel(section.first_axis, normal):
            hint = "give one not parallel to the normal: only its component perpendicular to the normal is used"
            yield Violation(("sections", name, "first_axis"), "first_axis points along the normal", hint)


@rule("strength-small", is_warning=True)
def check_strength_unit(draft: DraftDocument) -> Iterator[Violation]:
    """A plain number is in Pa: a strength of some hundreds is probably meant in MPa, such a modulus in GPa."""
    for name, section in draft.document.sections.items():
        for key, unit, example in (("strength", "MPa", "235 MPa"), ("modulus", "GPa", "210 GPa")):
            value = getattr(section, key)
            if value is not None and 0.0 < value < tolerances.LEAST_STRENGTH:
                suggestion = f"{value:g} {unit}" if value <= MAX_PLAUSIBLE_STRENGTH else example
                message = f"a {key} of {value:g} Pa is unusually low: a plain number is in Pa"
                yield Violation(("sections", name, key), message, f"give the unit, for example {suggestion}")


@rule("properties-form")
def check_properties_form(draft: DraftDocument) -> Iterator[Violation]:
    """Properties are those of one named shape, or all six numbers; a strength goes with them."""
    for name, section in draft.document.sections.items():
        properties = section.properties
        path = ("sections", name)
        if properties is None:
            if section.strength is not None:
                hint = "add properties: {circle: {radius: 10 mm}}, or properties: auto"
                yield Violation((*path, "strength"), "strength is given without properties", hint, key=True)
            continue
        if isinstance(properties, str):
            body = draft.document.bodies.get(section.body)
            if body is not None and body.shapes is None:
                message = f"{section.body} has no shapes to take them from"
                yield Violation(
                    (*path, "properties"), message, f"give circle, tube, rectangle, or all of {', '.join(GENERAL_KEYS)}"
                )
            continue
        shapes = [key for key in SECTION_SHAPES if getattr(properties, key) is not None]
        numbers = [key for key in GENERAL_KEYS if getattr(properties, key) is not None]
        if len(shapes) + bool(numbers) != 1:
            yield Violation(
                (*path, "properties"),
                "properties of one shape are needed",
                f"give auto, {', '.join(SECTION_SHAPES)}, or all of {', '.join(GENERAL_KEYS)}",
            )
        elif numbers and len(numbers) < len(GENERAL_KEYS):
            missing = ", ".join(key for key in GENERAL_KEYS if key not in numbers)
            yield Violation(
                (*path, "properties"), f"properties without {missing}", f"give all of {', '.join(GENERAL_KEYS)}"
            )
        yield from check_shear_factor(properties, (*path, "properties", "shear_factor"))
        tube = properties.tube
        if tube is not None and tube.inner_radius >= tube.radius:
            yield Violation(
                (*path, "properties", "tube"),
                f"inner_radius {tube.inner_radius:g} is not less than radius {tube.radius:g}",
                "for a solid section use circle",
            )


def check_shear_factor(properties: f.PropertiesEntry, path: tuple[str, ...]) -> Iterator[Violation]:
    """The largest shear stress over the mean is for a section given by numbers, and at least 1."""
    factor = properties.shear_factor
    if factor is None:
        return
    if properties.area is None:
        hint = f"use it with {', '.join(GENERAL_KEYS)}"
        yield Violation(path, "shear_factor is not for a named shape, which defines its shear stresses", hint, key=True)
    elif factor < 1.0:
        yield Violation(
            path, f"the largest shear stress over the mean must be at least 1, not {factor:g}", SHEAR_FACTOR_HINT
        )


@rule("deflection-form")
def check_deflection_form(draft: DraftDocument) -> Iterator[Violation]:
    """A deflection is that of a series of cuts with properties and a modulus."""
    for name, section in draft.document.sections.items():
        path = ("sections", name)
        if not section.deflection:
            for key in ("modulus", "reference", "length_factor"):
                if getattr(section, key) is not None:
                    yield Violation((*path, key), f"{key} is given without a deflection", ADD_DEFLECTION, key=True)
            continue
        if not is_cut_series(section):
            hint = "give from, to and count instead of at and normal"
            yield Violation((*path, "deflection"), "a single cut has no deflection", hint, key=True)
        for key, hint in (("properties", "add properties: auto"), ("modulus", "add modulus: 210 GPa, for steel")):
            if getattr(section, key) is None:
                yield Violation((*path, "deflection"), f"a deflection needs {key}", hint, key=True)


# Sensors


@rule("sensor-of")
def check_sensor_source(draft: DraftDocument) -> Iterator[Violation]:
    """A sensor reads the reaction of a joint, or the load of a single cut."""
    entries = draft.names.entries
    for name, sensor in draft.document.sensors.items():
        path = ("sensors", name, "of")
        block, _, source = sensor.of.partition(".")
        if block not in ("joints", "sections") or not source:
            owner = next((own for own in ("joints", "sections") if sensor.of in entries[own]), None)
            hint = f"write {owner}.{sensor.of}" if owner else "write joints.NAME or sections.NAME"
            yield Violation(path, f"'{sensor.of}' is not a reaction", hint)
        elif source not in entries[block]:
            yield Violation(path, f"'{source}' is not a {block[:-1]}", suggest(source, entries[block], block) or "")
        elif (
            block == "sections" and source in draft.document.sections and is_cut_series(draft.document.sections[source])
        ):
            hint = "give the section one cut: at and normal"
            yield Violation(path, f"'{source}' is a series of cuts, and a sensor has one place", hint)
