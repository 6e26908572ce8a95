"""Rules about bodies: mass properties that a rigid body can have, each given once."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.rotations import symmetric_eigenvalues
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import inertia_tensor, orientation_matrix

# hints for numbers that are too small
SIZES_HINT = "give a value above 0, in SI or with its unit"
EDGES_HINT = "its three edges, in m"
FULL_FRICTION_HINT = "the rate at which friction is nearly full, small compared with those of the motion: 0.01"
POSITIVE_HINTS = {
    "mass": "a body with mass 0 is a frame between others that have some; a massless bar "
    "is a joint of type rod, a massless spring a force of type spring",
    "duration": "for one instant leave duration and samples out", "step": "in s, or with a unit: 1 ms",
    "inner_radius": "a solid cylinder has no inner_radius",
    "length": "leave it out for the length as assembled; for 0 use a ball",
    "scale": "the length of one unit of the file: 1 mm",
    "strength": "in Pa, or with a unit: 235 MPa", "modulus": "in Pa, or with a unit: 210 GPa",
    "length_factor": "1 between two pins, 2 for a mast with a free end", "density": "in kg/m^3: 7850 is steel",
}  # fmt: skip
MASSLESS_HINT = "leave the inertia out: a frame without mass; or give the body a mass"
NEGATIVE_HINTS = {
    "torque": "it resists motion in both directions: give its magnitude",
    "force": "it resists motion in both directions: give its magnitude",
}


@rule("no-bodies")
def check_has_bodies(draft: DraftDocument) -> Iterator[Violation]:
    """A scene has bodies."""
    if not draft.names.entries["bodies"] and "bodies" not in draft.unread:
        yield Violation(
            (), "the model has no bodies", "bodies: {bar: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}"
        )


@rule("mass-or-shapes")
def check_mass_or_shapes(draft: DraftDocument) -> Iterator[Violation]:
    """A body has either mass, center and inertia, or shapes; a frame without mass, `mass: 0`, needs no more."""
    for name, body in draft.document.bodies.items():
        given_keys = [key for key in ("mass", "center", "inertia") if getattr(body, key) is not None]
        path = ("bodies", name)
        if body.shapes is not None:
            extra = [*given_keys, *(["deviation"] if body.deviation is not None else [])]
            if extra:
                yield Violation(
                    (*path, extra[0]),
                    f"{' and '.join(extra)} given together with shapes",
                    "shapes define all of them",
                    key=True,
                )
            if not body.shapes:
                yield Violation(
                    (*path, "shapes"), "shapes is an empty list", "without shapes give mass, center and inertia"
                )
        elif len(given_keys) < 3 and body.mass != 0.0:
            missing = [key for key in ("mass", "center", "inertia") if key not in given_keys]
            hint = (
                "inertia: [0, 0, 0] makes a point mass"
                if missing == ["inertia"]
                else "give mass, center and inertia, or shapes"
            )
            yield Violation(
                path, f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing", hint, key=True
            )


@rule("not-positive")
def check_positive(draft: DraftDocument) -> Iterator[Violation]:
    """Masses, sizes and stiffnesses are more than 0. Some bodies may be frames without mass, not all."""
    has_mass = any(body.mass or body.shapes for body in draft.document.bodies.values())
    for name, body in draft.document.bodies.items():
        path: Path_ = ("bodies", name)
        if body.mass != 0.0 or not has_mass:
            yield from require_positive(path, body, "mass")
        if body.piece is not None:
            yield from require_positive((*path, "piece"), body.piece, "mass")
        for i, shape in enumerate(body.shapes or []):
            shape_path = (*path, "shapes", i)
            yield from require_positive(shape_path, shape, "mass", "density", "line_density", "scale")
            if isinstance(shape, fs.MemberShape):
                continue  # its measures are checked together
            if not isinstance(shape, fs.ConeShape):
                yield from require_positive(shape_path, shape, "radius", "inner_radius")
            elif min(shape.radius, shape.to_radius) < 0.0 or max(shape.radius, shape.to_radius) == 0.0:
                message = "a cone's radii must not be negative, nor both 0"
                yield Violation((*shape_path, "radius"), message, "to_radius: 0 is a tip")
            if isinstance(shape, fs.BoxShape) and min(shape.size) <= 0.0:
                yield Violation(
                    (*shape_path, "size"), f"a size must be greater than 0, but is {min(shape.size):g}", EDGES_HINT
                )
    for name, joint in draft.document.joints.items():
        path = ("joints", name)
        yield from require_positive(path, joint, "length", "radius")
        if isinstance(joint, fj.Bearing) and joint.bearing is not None:
            yield from require_positive((*path, "bearing"), joint.bearing, "diameter", "width")
        if isinstance(joint.stiffness, float) and joint.stiffness <= 0.0:
            message = f"a stiffness must be greater than 0, but is {joint.stiffness:g}"
            yield Violation(
                (*path, "stiffness"), message, "with {moment: 0} or {force: 0} the other joints carry the load"
            )
        parts = [getattr(joint.stiffness, key, None) for key in ("force", "moment")]
        numbers = [n for part in parts for n in (part if isinstance(part, tuple) else (part,)) if isinstance(n, float)]
        if any(n < 0.0 for n in numbers):
            message = f"a stiffness must not be negative, as {min(numbers):g} is"
            yield Violation((*path, "stiffness"), message, "with 0 the other joints carry the load there")
    for name, load in draft.document.forces.items():
        path = ("forces", name)
        if isinstance(load, fl.FrictionEntry):
            yield from require_positive(path, load, "radius", "length")
        speed = load.speed if isinstance(load, fl.FrictionEntry) else None
        if speed is not None and speed.constant is not None and speed.constant <= 0.0:
            message = f"speed must be greater than 0, but is {speed.constant:g}"
            yield Violation((*path, "speed"), message, FULL_FRICTION_HINT)
    for name, section in draft.document.sections.items():
        yield from iter_section_sizes(("sections", name), section)
    for name, wheel in draft.document.rolling.items():
        yield from require_positive(("rolling", name), wheel, "radius")
    yield from require_positive(("analysis",), draft.document.analysis, "duration", "step")


def iter_section_sizes(path: Path_, section: f.SectionEntry) -> Iterator[Violation]:
    """Yield the sizes of a section that are not more than 0."""
    yield from require_positive(path, section, "strength", "modulus", "length_factor")
    if section.piece is not None:
        yield from require_positive((*path, "piece"), section.piece, "mass")
    for kind in ("circle", "tube", "rectangle"):
        cross_section = getattr(section.properties, kind, None)
        if cross_section is not None:
            yield from require_positive(
                (*path, "properties", kind), cross_section, "radius", "inner_radius", "width", "height"
            )
    if section.properties is not None:
        yield from require_positive((*path, "properties"), section.properties, "area", "I1", "I2", "J", "c1", "c2")


def require_positive(path: Path_, owner: object, *keys: str) -> Iterator[Violation]:
    """Yield a violation for each given value that is not more than 0."""
    for key in keys:
        value = getattr(owner, key, None)
        if isinstance(value, float) and value <= 0.0:
            yield Violation(
                (*path, key), f"{key} must be greater than 0, but is {value:g}", POSITIVE_HINTS.get(key, SIZES_HINT)
            )


@rule("negative")
def check_not_negative(draft: DraftDocument) -> Iterator[Violation]:
    """Coefficients of springs, dampers and friction, and tolerances of expectations, are not negative."""
    for name, load in draft.document.forces.items():
        for key, value in iter_resistances(load):
            if isinstance(value, float) and value < 0.0:
                hint = NEGATIVE_HINTS.get(
                    key, "give a resistance as a positive number; to drive, use a torque, a force or a drive"
                )
                yield Violation(("forces", name, key), f"{key} must not be negative, but is {value:g}", hint)
    for i, item in draft.document.expect.items():
        for key in ("rel", "abs"):
            value = getattr(item, key)
            value = getattr(value, "constant", value)
            if value is not None and value < 0.0:
                hint = "it is the allowed deviation in both directions"
                yield Violation(("expect", i, key), f"{key} must not be negative, but is {value:g}", hint)


def iter_resistances(load: fl.LoadEntry) -> Iterator[tuple[str, object]]:
    """Yield every number that says how strongly a load resists; laws are left out, because their sign says nothing."""
    for key in LOAD_KINDS[load.type].not_negative:
        value = getattr(load, key)
        if isinstance(value, fl.ShiftLaws | fl.TurnLaws):
            value = (value.x, value.y, value.z)
        for part in value if isinstance(value, tuple) and not isinstance(value[0], tuple) else (value,):
            yield key, getattr(part, "constant", part)


@rule("shape-form")
def check_shape_form(draft: DraftDocument) -> Iterator[Violation]:
    """A shape has one of mass and density, and an extent."""
    for name, body in draft.document.bodies.items():
        for i, shape in enumerate(body.shapes or []):
            path = ("bodies", name, "shapes", i)
            density = "line_density" if isinstance(shape, fs.RodShape) else "density"
            if not isinstance(shape, fs.PointShape):
                given_keys = [key for key in ("mass", density) if getattr(shape, key) is not None]
                if len(given_keys) != 1:
                    description = "both mass and" if given_keys else "neither mass nor"
                    yield Violation(path, f"{description} {density} given", "give one of the two")
            if (
                isinstance(shape, fs.RodShape | fs.CylinderShape | fs.ConeShape | fs.MemberShape | fs.ProfileShape)
                and shape.from_ == shape.to
            ):
                yield Violation((*path, "to"), "from and to are the same point", "for a point mass use type: point")
            if (
                isinstance(shape, fs.CylinderShape)
                and shape.inner_radius is not None
                and shape.inner_radius >= shape.radius
            ):
                message = f"inner_radius {shape.inner_radius:g} is not less than radius {shape.radius:g}"
                yield Violation((*path, "inner_radius"), message, "a solid cylinder has no inner_radius")


def iter_inertia_owners(draft: DraftDocument) -> Iterator[tuple[Path_, f.BodyEntry | f.PieceEntry]]:
    """Yield every body and piece with an inertia."""
    for name, body in draft.document.bodies.items():
        if body.inertia is not None:
            yield ("bodies", name), body
        if body.piece is not None:
            yield ("bodies", name, "piece"), body.piece
    for name, section in draft.document.sections.items():
        if section.piece is not None:
            yield ("sections", name, "piece"), section.piece


@rule("inertia-form")
def check_inertia_form(draft: DraftDocument) -> Iterator[Violation]:
    """A single number is for planar scenes only, deviation goes with a list only, a tensor is symmetric."""
    planar = draft.document.head.space == "planar"
    for path, owner in iter_inertia_owners(draft):
        inertia = owner.inertia
        if isinstance(inertia, float) and not planar:
            yield Violation(
                (*path, "inertia"),
                "one number is given instead of three",
                "one number needs space: planar; otherwise give [A1, A2, A3]",
            )
        if owner.deviation is not None and not isinstance(inertia, tuple | list):
            yield Violation(
                (*path, "deviation"), "deviation given with one number", "use it with [A1, A2, A3]", key=True
            )
        elif owner.deviation is not None and isinstance(inertia[0], tuple):  # type: ignore[index]
            yield Violation(
                (*path, "deviation"),
                "deviation given with a full tensor",
                "the tensor contains them: off-diagonal element = -product",
                key=True,
            )
        if isinstance(inertia, tuple) and isinstance(inertia[0], tuple):
            size = max(abs(x) for row in inertia for x in row)
            for i, j in ((0, 1), (0, 2), (1, 2)):
                if abs(inertia[i][j] - inertia[j][i]) > tolerances.INERTIA_TYPED * size:
                    message = f"the tensor is not symmetric: {inertia[i][j]:g} and {inertia[j][i]:g}"
                    hint = "make both equal, or give the moments and deviation: [D1, D2, D3]"
                    yield Violation((*path, "inertia"), message, hint)
                    break


def iter_impossible_moments(draft: DraftDocument) -> Iterator[tuple[Path_, str, float]]:
    """Yield principal moments that no body can have: path, moments as text, and the excess relative to the largest
    moment.
    """
    for path, owner in iter_inertia_owners(draft):
        if isinstance(owner.inertia, float):
            moments: tuple[float, ...] = (owner.inertia,)
            excess = 1.0 if owner.inertia < 0.0 else 0.0
        else:
            matrix = inertia_tensor(owner)
            a, b, c = moments = (
                symmetric_eigenvalues(matrix)
                if has_off_diagonal(matrix)
                else tuple(sorted(matrix[i][i] for i in range(3)))
            )
            scale = max(abs(a), abs(c))
            excess = max(-a, c - a - b) / scale if scale > 0.0 else 0.0
        if excess > tolerances.INERTIA_TYPED:
            yield (*path, "inertia"), ", ".join(f"{m:g}" for m in moments), excess


def has_off_diagonal(matrix: tuple[tuple[float, ...], ...]) -> bool:
    return any(matrix[i][j] != 0.0 for i, j in ((0, 1), (0, 2), (1, 2)))


@rule("inertia-not-physical")
def check_inertia_physical(draft: DraftDocument) -> Iterator[Violation]:
    """No principal moment is negative, or greater than the sum of the others; without mass all are 0."""
    for name, body in draft.document.bodies.items():
        if body.mass == 0.0 and body.inertia is not None and any(map(any, inertia_tensor(body))):
            yield Violation(("bodies", name, "inertia"), "the mass is 0, the inertia is not", MASSLESS_HINT)
    for path, moments, excess in iter_impossible_moments(draft):
        if excess > tolerances.INERTIA_REFUSED:
            message = f"the principal moments {moments} are impossible: each must be at most the sum of the other two"
            yield Violation(
                path,
                message,
                "check that it is about the centre of mass, and the signs (off-diagonal element = -product of inertia)",
            )


@rule("inertia-rounded", is_warning=True)
def check_inertia_rounded(draft: DraftDocument) -> Iterator[Violation]:
    """Moments that break the triangle rule by less than 1e-3 are assumed to be rounded."""
    for path, moments, excess in iter_impossible_moments(draft):
        if excess <= tolerances.INERTIA_REFUSED:
            yield Violation(
                path, f"the principal moments {moments} violate A1 + A2 >= A3 by {excess:.1e}; used as given",
                "give them with more digits",
            )  # fmt: skip


@rule("orientation")
def check_orientation(draft: DraftDocument) -> Iterator[Violation]:
    """An orientation has one form, and is a rotation."""
    for path, value in iter_orientations(draft):
        try:
            orientation_matrix(value)
        except Finding as finding:
            yield Violation(path, finding.message, finding.hint)


def iter_orientations(draft: DraftDocument) -> Iterator[tuple[Path_, fs.Orientation]]:
    """Yield every orientation in the document."""
    for name, body in draft.document.bodies.items():
        if body.orientation is not None:
            yield ("bodies", name, "orientation"), body.orientation
        if body.near is not None and body.near.orientation is not None:
            yield ("bodies", name, "near", "orientation"), body.near.orientation
        for i, shape in enumerate(body.shapes or []):
            if isinstance(shape, fs.BoxShape | fs.MeshShape) and shape.orientation is not None:
                yield ("bodies", name, "shapes", i, "orientation"), shape.orientation
    for name, load in draft.document.forces.items():
        for key in ("orientation", "to_orientation") if isinstance(load, fl.BushingEntry) else ():
            if getattr(load, key) is not None:
                yield ("forces", name, key), getattr(load, key)


@rule("piece-form")
def check_piece_form(draft: DraftDocument) -> Iterator[Violation]:
    """A piece is for the only cut of a body without shapes."""
    cuts: dict[str, list[str]] = {}
    for name, section in draft.document.sections.items():
        cuts.setdefault(section.body, []).append(name)
        body = draft.document.bodies.get(section.body)
        if section.piece is not None and body is not None and body.shapes is not None:
            yield Violation(
                ("sections", name, "piece"),
                "a piece is given for a body with shapes",
                "leave it out: heun cuts the shapes",
                key=True,
            )
    for name, body in draft.document.bodies.items():
        if body.piece is None:
            continue
        if body.shapes is not None:
            yield Violation(
                ("bodies", name, "piece"),
                "a piece is given together with shapes",
                "leave it out: heun cuts the shapes",
                key=True,
            )
        elif len(cuts.get(name, ())) > 1:
            message = f"one piece is given for {len(cuts[name])} sections ({', '.join(cuts[name])})"
            yield Violation(("bodies", name, "piece"), message, "give each section its own piece", key=True)
