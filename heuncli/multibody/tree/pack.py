"""Lay out the assembled mechanism as the kernel's tables (their fields: kernel/scene.py)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import JointLoad
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.tree.body_rows import TreeRows
from heuncli.multibody.tree.closure_rows import ClosureRows, index_rows
from heuncli.multibody.tree.islands import add_islands
from heuncli.multibody.tree.layout import Layout, LayoutFrame, make_frame
from heuncli.multibody.tree.load_rows import find_used_names, lay_out_loads, make_programs
from heuncli.multibody.tree.spanning import find_spanning_tree
from heuncli.multibody.tree.starts import JointStart, PresetTree, compute_joint_start
from heuncli.multibody.tree.tables import Program, limits_table, make_table, moves_in_plane
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Pack


def lay_out(
    mechanism: Mechanism,
    start: Assembly,
    inertias: Array,
    size: float,
    work: bool = True,
    tree: PresetTree | None = None,
) -> Layout:
    """Lay the scene out from its assembled start.

    inertias (n, 3, 3): about the centres of mass, body axes, with the artificial inertia
    size: of the scene [m]
    work: whether the work of drives and of loads without potential is part of the state
    tree: of a larger scene, to be kept
    """
    programs, used_names = make_programs(mechanism), find_used_names(mechanism)
    frame = build_frame(mechanism, start, inertias, size, work, used_names, programs.drives, tree)
    return lay_out_loads(frame, mechanism, programs)


def lay_out_like(
    layout: Layout, mechanism: Mechanism, start: Assembly, inertias: Array, starts: Sequence[JointStart]
) -> Layout:
    """Lay out a scene that was made from one laid out already, with its tree, size and programs; starts: of the joints.

    Its own programs come after those of the other scene, so that the branches of both are the same. Those of load
    components that it leaves out are watched as well: the other scene's loads are recovered with them.
    """
    programs = make_programs(layout.mechanism).extend(mechanism)
    tree = PresetTree(layout.spanning, tuple(starts))
    work = layout.work_at >= 0
    frame = build_frame(mechanism, start, inertias, layout.size, work, frozenset(), programs.drives, tree)
    left_out = [e for load in layout.mechanism.loads for e in load.values if e.held_branches]
    return lay_out_loads(frame, mechanism, programs, left_out=left_out)


def build_frame(
    mechanism: Mechanism,
    start: Assembly,
    inertias: Array,
    size: float,
    work: bool,
    used_names: frozenset[str],
    drives: tuple[Program, ...],
    tree: PresetTree | None,
) -> LayoutFrame:
    """Build a layout without its loads.

    used_names: joints and points that expressions use
    drives: a program for each joint, then for each coupling
    """
    spanning = (
        find_spanning_tree(
            mechanism, find_uncut_joints(mechanism, used_names), [own.joint for own in mechanism.iter_sticking()]
        )
        if tree is None
        else tree.spanning
    )
    if tree is not None and tree.starts is not None:
        starts = list(tree.starts)
    else:
        starts = [compute_joint_start(mechanism, start, joint) for joint in mechanism.joints]
    tree_rows = TreeRows(mechanism, start, spanning, starts, inertias, size, drives)
    return assemble_frame(tree_rows, ClosureRows(tree_rows), work)


def find_uncut_joints(mechanism: Mechanism, used_names: frozenset[str]) -> set[int]:
    """Return the joints that must not be cut."""
    uncut = {k for k, j in enumerate(mechanism.joints) if j.name in used_names}
    uncut |= {s.joint for s in mechanism.stops if s.quantity != "length"}
    uncut |= {k for k, j in enumerate(mechanism.joints) if j.drive is not None and j.drive.quantity != "length"}
    # the angle of a cut universal cannot be determined
    uncut |= {k for coupling in mechanism.couplings for k in coupling.joints}
    return uncut | {k for k in find_sprung_joints(mechanism) if len(JOINTS[mechanism.joints[k].kind].turns) == 2}


def find_sprung_joints(mechanism: Mechanism) -> set[int]:
    """Return the joints with springs about their axes."""
    return {load.joint for load in mechanism.loads if isinstance(load, JointLoad) and load.row.has_potential}


def assemble_frame(tree: TreeRows, closures: ClosureRows, work: bool) -> LayoutFrame:
    """Add counted angles and the work to the state, and make the tables."""
    driven = bool(tree.mechanism.laws)
    energy_group = -1
    for k in closures.counters:
        closures.counters[k] = len(tree.y)
        on_path = tree.mechanism.joints[k].path is not None
        tree.y.append(tree.starts[k].travel if on_path else tree.starts[k].angle)
        tree.weights.append(0.0)
    work_at = len(tree.y) if work else -1
    if work:
        tree.y.append(0.0)
        tree.weights.append(1.0 if driven else 0.0)
        if driven:
            # the drives' work may vary where the motion does not: it has a say in the step
            energy_group = len(tree.groups)
            tree.groups.append(kernel.Group(coordinates=work_at, rates=work_at, end=work_at + 1))
    closure_rows, indices, column_count = index_rows(closures.rows, closures.paths, tree.body_rows)
    tables = {
        "bodies": make_table(kernel.Body, tree.body_rows),
        "freedoms": make_table(kernel.Freedom, tree.freedom_rows),
        "closures": make_table(kernel.Closure, closure_rows),
        "pieces": make_table(kernel.PathPiece, tree.pieces),
        "parts": make_table(kernel.Closure, closures.part_rows),
        "counters": make_table(kernel.Counter, closures.make_counter_rows()),
        "contacts": make_table(kernel.Contact, closures.one_sided),
        "groups": make_table(kernel.Group, tree.groups),
        "artificial_inertias": make_table(kernel.ArtificialInertia, []),
        "limits": limits_table(tolerances.KERNEL),
    }
    layout = Layout(
        mechanism=tree.mechanism,
        spanning=tree.spanning,
        place=tree.place,
        reference=tree.reference,
        freedoms=tuple(tree.freedoms),
        rows=tuple(closures.row_joint),
        starts=tuple(tree.starts),
        counters=closures.counters,
        size=tree.size,
        y0=np.array(tree.y),
        energy_group=energy_group,
        weights=np.array(tree.weights),
        tables=tables,
        indices=indices,
        velocity_count=tree.velocity_count,
        column_count=column_count,
        pack=Pack(),
        work_at=work_at,
        islands=(),
        contacts=tuple(closures.contacts),
        velocity_scale=np.zeros(0),
        flat=closures.is_flat and moves_in_plane(tables["bodies"], tables["freedoms"]),
    )
    return make_frame(add_islands(layout))
