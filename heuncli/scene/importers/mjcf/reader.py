"""Read MJCF into a described machine: MuJoCo compiles the model, and its arrays are translated to the terms of a
spec.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import ZERO
from heuncli.scene.importers.description import (
    LEFT_OUT_CODE,
    DescribedBody,
    DescribedEntry,
    DescribedMachine,
    ImportOptions,
    Namer,
    format_original_name,
    make_label,
)
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel, collect_model_files, compile_model
from heuncli.scene.importers.mjcf.laws import JointLaws, build_joint_laws
from heuncli.scene.importers.mjcf.loads import (
    iter_gravity_compensation,
    iter_joint_loads,
    iter_stops,
)
from heuncli.scene.importers.mjcf.loop_closures import ClosureBuilder, LoopClosures
from heuncli.scene.importers.mjcf.no_counterpart import find_unsupported
from heuncli.scene.importers.mjcf.starts import StartKeys, choose_held_joints, find_joint_places, find_starts
from heuncli.scene.importers.mjcf.tendons import iter_tendon_springs
from heuncli.scene.importers.mjcf.tree import (
    CARRIER_MASS_RATIO,
    FREE,
    GROUND,
    BodyFrames,
    BodyPoints,
    JointTree,
    TreeJoint,
    build_tree,
    compute_frames,
    compute_mass_properties,
    to_vec,
)
from heuncli.scene.importers.xml_elements import XmlElement

ZERO_INERTIA: Matrix = (ZERO, ZERO, ZERO)
USED_ARRAYS = (  # the arrays whose numbers enter a spec
    "body_pos", "body_quat", "body_mass", "body_inertia", "body_ipos", "body_iquat", "body_gravcomp", "jnt_pos",
    "jnt_axis", "jnt_range", "jnt_stiffness", "dof_damping", "qpos0", "qpos_spring", "site_pos", "site_quat", "eq_data",
    "tendon_length0", "tendon_lengthspring", "tendon_stiffness", "tendon_damping", "key_qpos", "key_qvel",
)  # fmt: skip


def read_model(content: bytes, file: str, root: XmlElement, options: ImportOptions, sha256: str) -> DescribedMachine:
    """Read the machine that a MuJoCo model describes. Raises SpecError."""
    compiled = compile_model(content, file, collect_model_files(root, file))
    _require_finite(compiled)
    if not any(compute_frames(compiled.model).owners):
        message = "nothing can move: no body has a joint"
        raise SpecError(Problem("import-mass", message, SourceLocation(file, 1, 1), "is it the right file?"))
    return _MachineBuilder(compiled, options).build(sha256)


class _MachineBuilder:
    """Builds the machine of one model. Entries are made in the order in which their names are assigned."""

    def __init__(self, compiled: CompiledModel, options: ImportOptions) -> None:
        self.compiled, self.options = compiled, options
        self.frames: BodyFrames = compute_frames(compiled.model)
        self.tree: JointTree = build_tree(compiled, self.frames)
        self.points = BodyPoints()
        joint_names = Namer("joint")
        joint_names.used_names |= {step.name for step in self.tree.steps}
        self.joints = [self.make_joint(step) for step in self.tree.steps if step.kind != FREE]
        self.closure_builder = ClosureBuilder(compiled, self.frames, self.tree, self.points, joint_names.assign)
        self.closures: LoopClosures = self.closure_builder.build()
        self.q, self.qd = _find_start_values(compiled, options.keyframe)
        self.held_joints = choose_held_joints(compiled, self.tree, self.closures, self.q)
        self.laws: JointLaws = build_joint_laws(
            compiled, self.tree, self.held_joints, self.closures.couplings, self.q, self.qd, options
        )
        self.names = joint_names  # stops, joints, forces and drives have different names
        self.names.used_names |= {entry.name for entry in (*self.laws.drives, *self.laws.couplings)}

    def build(self, sha256: str) -> DescribedMachine:
        """Build the machine."""
        compiled, model = self.compiled, self.compiled.model
        gravity = ZERO if compiled.is_disabled("GRAVITY") else to_vec(model.opt.gravity)
        forces = (
            *iter_joint_loads(compiled, self.tree, self.names.assign),
            *iter_tendon_springs(compiled, self.closure_builder, self.tree, self.names.assign),
            *iter_gravity_compensation(
                compiled, self.frames, self.tree, self.points, gravity, self.names.assign, self.options.free
            ),
        )
        limits = (
            tuple(iter_stops(compiled, self.tree, self.laws.driven_joints, self.names.assign))
            if self.options.limits
            else ()
        )
        self.add_sites()
        left_out = (
            *self.laws.left_out,
            *self.closures.left_out,
            *find_unsupported(compiled, self.closures.rods, self.options.limits, self.options.free),
            *_find_left_out_controls(compiled, self.options),
        )
        return DescribedMachine(
            title=_read_title(compiled),
            form="MJCF",
            file=compiled.file,
            sha256=sha256,
            gravity=gravity,
            bodies=tuple(self.iter_bodies()),
            ground=self.points.get_points(GROUND),
            parameters=self.laws.parameters,
            joints=tuple(self.add_initial(joint) for joint in (*self.joints, *self.closures.joints)),
            drives=(*self.laws.drives, *self.closures.drives),
            couplings=(*self.laws.couplings, *self.closures.ratios),
            forces=forces,
            stops=limits,
            header_lines=tuple(self.iter_header_lines()),
            remarks={"parameters": "joint positions"},
            left_out=left_out,
        )

    def make_joint(self, step: TreeJoint) -> DescribedEntry:
        """Make a joint of the tree."""
        compiled = self.compiled
        ends = (
            self.points.add(body, step.name, place)
            for body, place in zip(
                (step.parent, step.child), find_joint_places(compiled, self.frames, step), strict=True
            )
        )
        keys: dict[str, Any] = {"type": step.kind, "from": next(ends), "to": next(ends)}
        if step.joint is None:
            return DescribedEntry(step.name, keys, f"{compiled.describe_part('body', step.body)} has no joint")
        if step.kind != "ball":
            keys["axis"] = self.frames.transform_direction(step.body, compiled.model.jnt_axis[step.joint])
        original = compiled.name("joint", step.joint) or step.name
        keys |= make_label(step.name, original)
        return DescribedEntry(step.name, keys, format_original_name("joint", step.name, original))

    def add_initial(self, joint: DescribedEntry) -> DescribedEntry:
        initial = self.laws.initial.get(joint.name)
        return joint._replace(keys={**joint.keys, "initial": initial}) if initial else joint

    def add_sites(self) -> None:
        """Add the sites, and the bodies that are fixed frames of others, as named points."""
        model, frames = self.compiled.model, self.frames
        for body, owner in enumerate(frames.owners):
            if body and owner != body:
                name = self.compiled.name("body", body)
                if name:
                    self.points.add(
                        self.tree.names[owner], name, frames.origins[body], format_original_name("body", name, name)
                    )
        for site in range(self.compiled.count("site")):
            body = int(model.site_bodyid[site])
            name = self.compiled.name("site", site) or f"site_{site + 1}"
            self.points.add(
                self.tree.names[frames.owners[body]], name, frames.transform_point(body, model.site_pos[site])
            )

    def iter_bodies(self) -> Iterator[DescribedBody]:
        """Yield the bodies of the model, and the carriers between stacked joints."""
        starts = find_starts(self.compiled, self.tree, self.closures, self.held_joints, self.frames, self.q, self.qd)
        owners = {name: body for body, name in self.tree.names.items()}
        for name in dict.fromkeys(step.child for step in self.tree.steps):
            start = starts.get(name, StartKeys({}, {}))
            if name in self.tree.carriers:
                carried_mass = compute_mass_properties(self.compiled.model, self.frames, self.tree.carriers[name])
                carried_name = self.tree.names[self.tree.carriers[name]]
                remark = (
                    f"auxiliary body between the joints of {carried_name}; its mass, "
                    f"{CARRIER_MASS_RATIO:g} of that body's, is negligible"
                )
                yield DescribedBody(
                    name,
                    CARRIER_MASS_RATIO * carried_mass.mass,
                    ZERO,
                    ZERO_INERTIA,
                    self.points.get_points(name),
                    (),
                    start.keys,
                    remark,
                    start.notes,
                )
                continue
            mass = compute_mass_properties(self.compiled.model, self.frames, owners[name])
            remark = format_original_name("body", name, self.tree.originals[owners[name]])
            yield DescribedBody(
                name,
                mass.mass,
                mass.center,
                mass.inertia,
                self.points.get_points(name),
                (),
                {**make_label(name, self.tree.originals[owners[name]]), **start.keys},
                remark,
                start.notes,
            )

    def iter_header_lines(self) -> Iterator[str]:
        compiled, model = self.compiled, self.compiled.model
        yield from self.laws.header_lines
        if self.tree.carriers:
            yield "MuJoCo stacks joints on one body; here auxiliary bodies of negligible mass connect them."
        free = [step.child for step in self.tree.steps if step.kind == FREE]
        if free:
            yield f"Free bodies (freejoint): {', '.join(free)}."
        ground = sum(float(model.body_mass[body]) for body, owner in enumerate(self.frames.owners) if owner == 0)
        if ground > 0.0:
            yield f"Fixed bodies belong to the ground; their {ground:.6g} kg are not in the load on the foundation."
        if self.closures.imported_equalities:
            yield "Equalities are soft in MuJoCo and exact here."
        yield from self.closures.header_lines
        yield from (f"MuJoCo warns: {text}" for text in compiled.warning_texts)


def _find_start_values(compiled: CompiledModel, keyframe: str | None) -> tuple[Any, Any]:
    """Return MuJoCo's coordinates and rates at the start. Raises SpecError [import-keyframe] if there is no such
    keyframe.
    """
    model = compiled.model
    if keyframe is None:
        return np.array(model.qpos0), np.zeros(int(model.nv))
    names = [compiled.name("keyframe", number) for number in range(compiled.count("keyframe"))]
    numbers = [str(number) for number in range(len(names))]
    if keyframe in names or keyframe in numbers:
        number = names.index(keyframe) if keyframe in names else int(keyframe)
        return np.array(model.key_qpos[number]), np.array(model.key_qvel[number])
    hint = suggest(keyframe, [name for name in names if name], "keyframes") if any(names) else "leave out --keyframe"
    message = f"there is no keyframe {keyframe!r}; number of keyframes: {len(names)}"
    raise SpecError(Problem("import-keyframe", message, SourceLocation(compiled.file, 1, 1), hint))


def _find_left_out_controls(compiled: CompiledModel, options: ImportOptions) -> Iterator[Problem]:
    """Yield a problem if a keyframe's controls would move joints that are left free."""
    names = [
        options.keyframe == compiled.name("keyframe", k) or options.keyframe == str(k)
        for k in range(compiled.count("keyframe"))
    ]
    if options.free and any(names) and np.any(compiled.model.key_ctrl[names.index(True)]):
        message = f"the controls (ctrl) of the keyframe {options.keyframe!r} are left out"
        hint = "write what the motors exert as torques, or leave out --free"
        yield Problem(LEFT_OUT_CODE, message, SourceLocation(compiled.file, 1, 1), hint)


def _require_finite(compiled: CompiledModel) -> None:
    """Raise SpecError [import-number] if a number that is read is not finite: MuJoCo accepts nan, with a warning."""
    model = compiled.model
    wrong = [name for name in USED_ARRAYS if not np.isfinite(np.asarray(getattr(model, name))).all()]
    if not np.isfinite(np.asarray(model.opt.gravity)).all():
        wrong.append("gravity")
    if wrong:
        message = f"numbers that are not finite: {', '.join(wrong)}"
        hint = "the exporting program may have divided by 0: correct the value in its source"
        raise SpecError(Problem("import-number", message, SourceLocation(compiled.file, 1, 1), hint))


def _read_title(compiled: CompiledModel) -> str:
    """Return the model's own name, which is the first of its names."""
    text = bytes(compiled.model.names).split(b"\0", 1)[0].decode("utf-8", "replace")
    return text or "MuJoCo model"
