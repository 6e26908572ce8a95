"""MJCF -> a described machine: compiled by MuJoCo, read from its arrays, said in the words of a spec."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format.models import ZERO, Matrix
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.described import DescribedBody, DescribedEntry, DescribedMachine
from heuncli.scene.importers.mjcf.closings import Closer, Closings
from heuncli.scene.importers.mjcf.compiled import Compiled, compiled
from heuncli.scene.importers.mjcf.frames import BodyFrames, frames_of, mass_properties, vec
from heuncli.scene.importers.mjcf.holding import held
from heuncli.scene.importers.mjcf.laws import JointLaws, laws_of
from heuncli.scene.importers.mjcf.loads import joint_loads, stops, tendon_springs, weightless
from heuncli.scene.importers.mjcf.named_files import named_files
from heuncli.scene.importers.mjcf.no_counterpart import without_counterpart
from heuncli.scene.importers.mjcf.points import PointsMade
from heuncli.scene.importers.mjcf.poses import sides
from heuncli.scene.importers.mjcf.starts import StartKeys, starts_of
from heuncli.scene.importers.mjcf.tree import CARRIER, FREE, GROUND, JointTree, TreeStep, tree_of
from heuncli.scene.importers.names import Namer, called
from heuncli.scene.importers.xml_elements import XmlElement

NOTHING: Matrix = (ZERO, ZERO, ZERO)
READ = (  # the arrays whose numbers come into a spec
    "body_pos", "body_quat", "body_mass", "body_inertia", "body_ipos", "body_iquat", "body_gravcomp", "jnt_pos",
    "jnt_axis", "jnt_range", "jnt_stiffness", "dof_damping", "qpos0", "qpos_spring", "site_pos", "site_quat", "eq_data",
    "tendon_length0", "tendon_lengthspring", "tendon_stiffness", "tendon_damping", "key_qpos", "key_qvel",
)  # fmt: skip


def described(content: bytes, file: str, root: XmlElement, asked: ImportAsked, sha256: str) -> DescribedMachine:
    """The machine that a model of MuJoCo's describes. Raises SpecError."""
    c = compiled(content, file, named_files(root, file))
    _require_finite(c)
    if not any(frames_of(c.model).owners):
        message = "nothing moves in it: no body has a joint"
        raise SpecError(Problem("import-mass", message, SourceLocation(file, 1, 1), "is it the right file?"))
    return _Said(c, asked).machine(sha256)


class _Said:
    """One model on its way: entries are made in the order in which their names are given."""

    def __init__(self, c: Compiled, asked: ImportAsked) -> None:
        self.c, self.asked = c, asked
        self.frames: BodyFrames = frames_of(c.model)
        self.tree: JointTree = tree_of(c, self.frames)
        self.points = PointsMade()
        joint_names = Namer("joint")
        joint_names.given |= {step.name for step in self.tree.steps}
        self.joints = [self.joint(step) for step in self.tree.steps if step.kind != FREE]
        self.closer = Closer(c, self.frames, self.tree, self.points, joint_names.name)
        self.closings: Closings = self.closer.closings()
        self.q, self.qd = _start_values(c, asked.keyframe)
        self.held = held(c, self.tree, self.closings, self.q)
        self.laws: JointLaws = laws_of(c, self.tree, self.held, self.closings.couplings, self.q, self.qd, asked)
        self.names = joint_names  # a stop shares its name with no joint, force or drive
        self.names.given |= {entry.name for entry in (*self.laws.drives, *self.laws.couplings)}

    def machine(self, sha256: str) -> DescribedMachine:
        """The machine."""
        c, model = self.c, self.c.model
        gravity = ZERO if c.switched_off("GRAVITY") else vec(model.opt.gravity)
        forces = (
            *joint_loads(c, self.tree, self.names.name),
            *tendon_springs(c, self.closer, self.names.name),
            *weightless(c, self.frames, self.tree, self.points, gravity, self.names.name, self.asked.free),
        )
        limits = tuple(stops(c, self.tree, self.laws.driven, self.names.name)) if self.asked.limits else ()
        self.sites()
        left_out = (
            *self.laws.left_out,
            *self.closings.left_out,
            *without_counterpart(c, self.closings.rods, self.asked.limits, self.asked.free),
        )
        return DescribedMachine(
            title=_title(c),
            form="MJCF",
            file=c.file,
            sha256=sha256,
            gravity=gravity,
            bodies=tuple(self.bodies()),
            ground=self.points.of(GROUND),
            parameters=self.laws.parameters,
            joints=tuple(self.with_initial(joint) for joint in (*self.joints, *self.closings.joints)),
            drives=self.laws.drives,
            couplings=self.laws.couplings,
            forces=forces,
            stops=limits,
            told=tuple(self.told()),
            remarks={"parameters": "where the joints stand"},
            left_out=left_out,
        )

    def joint(self, step: TreeStep) -> DescribedEntry:
        """A joint of the tree."""
        c = self.c
        ends = (
            self.points.add(body, step.name, place)
            for body, place in zip((step.parent, step.child), sides(c, self.frames, step), strict=True)
        )
        keys: dict[str, Any] = {"type": step.kind, "from": next(ends), "to": next(ends)}
        if step.joint is None:
            return DescribedEntry(step.name, keys, f"{c.told('body', step.body)} has no joint")
        if step.kind != "ball":
            keys["axis"] = self.frames.direction(step.body, c.model.jnt_axis[step.joint])
        return DescribedEntry(step.name, keys, called("joint", step.name, c.name("joint", step.joint) or step.name))

    def with_initial(self, joint: DescribedEntry) -> DescribedEntry:
        initial = self.laws.initial.get(joint.name)
        return joint._replace(keys={**joint.keys, "initial": initial}) if initial else joint

    def sites(self) -> None:
        """Sites, and bodies that are fixed frames of others, are named points."""
        model, frames = self.c.model, self.frames
        for body, owner in enumerate(frames.owners):
            if body and owner != body:
                name = self.c.name("body", body)
                if name:
                    self.points.add(self.tree.names[owner], name, frames.origins[body], called("body", name, name))
        for site in range(self.c.count("site")):
            body = int(model.site_bodyid[site])
            name = self.c.name("site", site) or f"site_{site + 1}"
            self.points.add(self.tree.names[frames.owners[body]], name, frames.place(body, model.site_pos[site]))

    def bodies(self) -> Iterator[DescribedBody]:
        """The bodies of the model, and the carriers between stacked joints."""
        starts = starts_of(self.c, self.tree, self.closings, self.held, self.frames, self.q, self.qd)
        owners = {name: body for body, name in self.tree.names.items()}
        for name in dict.fromkeys(step.child for step in self.tree.steps):
            start = starts.get(name, StartKeys({}, {}))
            if name in self.tree.carriers:
                carried = mass_properties(self.c.model, self.frames, self.tree.carriers[name])
                its = self.tree.names[self.tree.carriers[name]]
                remark = (
                    f"between the joints of {its}: no body of the file; its mass, {CARRIER:g} of that, adds nothing"
                )
                yield DescribedBody(
                    name,
                    CARRIER * carried.mass,
                    ZERO,
                    NOTHING,
                    self.points.of(name),
                    (),
                    start.keys,
                    remark,
                    start.notes,
                )
                continue
            mass = mass_properties(self.c.model, self.frames, owners[name])
            remark = called("body", name, self.tree.wanted[owners[name]])
            yield DescribedBody(
                name, mass.mass, mass.center, mass.inertia, self.points.of(name), (), start.keys, remark, start.notes
            )

    def told(self) -> Iterator[str]:
        c, model = self.c, self.c.model
        yield from self.laws.told
        if self.tree.carriers:
            yield "MuJoCo stacks joints on one body; here a body without weight stands between any two of them."
        free = [step.child for step in self.tree.steps if step.kind == FREE]
        if free:
            yield f"On no joint of the tree (freejoint): {', '.join(free)}."
        ground = sum(float(model.body_mass[body]) for body, owner in enumerate(self.frames.owners) if owner == 0)
        if ground > 0.0:
            yield f"What does not move is the ground; its {ground:.6g} kg are not in the load on the foundation."
        if self.closings.joints:
            yield "Equalities, soft in MuJoCo, are rigid joints here."
        yield from self.closings.told
        yield from (f"MuJoCo warns: {text}" for text in c.warned)


def _start_values(c: Compiled, keyframe: str | None) -> tuple[Any, Any]:
    """Coordinates and rates of MuJoCo's at the start. Raises SpecError where there is no such keyframe."""
    model = c.model
    if keyframe is None:
        return np.array(model.qpos0), np.zeros(int(model.nv))
    names = [c.name("keyframe", number) for number in range(c.count("keyframe"))]
    numbers = [str(number) for number in range(len(names))]
    if keyframe in names or keyframe in numbers:
        number = names.index(keyframe) if keyframe in names else int(keyframe)
        return np.array(model.key_qpos[number]), np.array(model.key_qvel[number])
    hint = (
        did_you_mean(keyframe, [name for name in names if name], "keyframes") if any(names) else "leave --keyframe out"
    )
    message = f"no keyframe is called {keyframe!r}; there are {len(names)}"
    raise SpecError(Problem("import-keyframe", message, SourceLocation(c.file, 1, 1), hint))


def _require_finite(c: Compiled) -> None:
    """Raise SpecError where a number that is read is none: MuJoCo lets nan pass, with a warning."""
    model = c.model
    wrong = [name for name in READ if not np.isfinite(np.asarray(getattr(model, name))).all()]
    if not np.isfinite(np.asarray(model.opt.gravity)).all():
        wrong.append("gravity")
    if wrong:
        message = f"numbers that are not finite: {', '.join(wrong)}"
        hint = "the program that wrote it divided by 0: its source needs the number"
        raise SpecError(Problem("import-number", message, SourceLocation(c.file, 1, 1), hint))


def _title(c: Compiled) -> str:
    """The model's own name, which stands first among its names."""
    text = bytes(c.model.names).split(b"\0", 1)[0].decode("utf-8", "replace")
    return text or "A model of MuJoCo's"
