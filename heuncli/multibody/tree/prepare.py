"""A mechanism made ready to run: assembled and laid out; what has no inertia to turn with set aside."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import record, replace
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.mechanism.size import size_of_scene
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.frame import LayoutFrame
from heuncli.multibody.tree.idle_spins import IdleSpin, idle_spins, without_inertia
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.load_rows import named_in, programs_of, with_loads
from heuncli.multibody.tree.pack import framed
from heuncli.multibody.tree.rows import Program
from heuncli.multibody.tree.spanning import Spanning
from heuncli.multibody.tree.starts import GivenTree, JointStart
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


@record
class PreparedScene:
    """A mechanism with its start and its layout for the kernel."""

    mechanism: Mechanism
    start: Assembly
    idle: tuple[IdleSpin, ...]
    layout: Layout

    @property
    def undetermined(self) -> int:
        """How many freedoms are spins that no law determines: none of them moves anything else."""
        if not self.mechanism.planar:
            return sum(len(spin.axes) for spin in self.idle)
        return sum(float(np.sum(spin.axes[:, 2] ** 2)) >= tolerances.ALONG_SQUARED for spin in self.idle)


def prepare(
    mechanism: Mechanism,
    t0: float = 0.0,
    stages: Stages = ANEW,
    fit: Callable[[PreparedScene], PreparedScene] | None = None,
) -> PreparedScene:
    """Assemble at t0 and lay out. Raises SolveError where the scene does not close, or starts beyond a stop.

    fit: makes of a scene that its joints close one that meets what else its start has to.
    """
    start = assemble(mechanism, t0, stages)
    if any(j.drive is not None and j.drive.adds_to_start for j in mechanism.joints):
        from heuncli.multibody.tree.driven_starts import begun  # few scenes have drives by a rate

        mechanism = begun(mechanism, start)
    if mechanism.couplings:
        from heuncli.multibody.tree.couplings_at_start import with_started  # few scenes have them

        mechanism = with_started(mechanism, start, t0)
    scene = arranged(mechanism, start, stages=stages)
    if fit is not None:
        scene = fit(scene)
    if mechanism.stops:
        from heuncli.multibody.tree.limits import at_rest_on_stops, start_within_limits  # where something strikes

        start_within_limits(scene.layout, scene.start)
        resting = at_rest_on_stops(mechanism, scene.layout, scene.start)
        if resting is not None:
            with suppress(SolveError):  # what is held makes it strike
                at_rest = arranged(mechanism, assemble(resting, t0))
                scene = at_rest if fit is None else fit(at_rest)
    return scene


def arranged(
    mechanism: Mechanism,
    start: Assembly,
    *,
    spanning: Spanning | None = None,
    size: float | None = None,
    starts: tuple[JointStart, ...] | None = None,
    stages: Stages = ANEW,
) -> PreparedScene:
    """Lay out an assembled mechanism; bodies with an undetermined spin get some inertia and no spin about its axis.

    spanning, size, starts: of the tree, the scene [m] and its joints, where they are those of another scene; stages:
    all but the loads is one.
    """
    programs, named = programs_of(mechanism), named_in(mechanism)
    tree = None if spanning is None else GivenTree(spanning, starts)
    found = stages.run(arrangement, mechanism, start, named, programs.drives, size, tree)
    start = replace(start, angular_velocity=found.omega)
    return PreparedScene(mechanism, start, found.idle, with_loads(found.frame, mechanism, programs, stages))


@record
class Arrangement:
    """What of a laid-out scene hangs on no value of a load; omega (n, 3): angular velocities at the start."""

    idle: tuple[IdleSpin, ...]
    omega: Array
    frame: LayoutFrame


def arrangement(
    mechanism: Mechanism,
    start: Assembly,
    named: frozenset[str],
    drives: tuple[Program, ...],
    size: float | None,
    tree: GivenTree | None,
) -> Arrangement:
    """Undetermined spins, and the frame; named, drives: as of `framed`."""
    size = size_of_scene(mechanism, start) if size is None else size
    idle = tuple(idle_spins(mechanism, size))
    inertias = np.array([b.inertia for b in mechanism.bodies])
    omega = start.angular_velocity.copy()
    for spin in idle:
        inertias[spin.body] += spin.lent
        axes = spin.axes @ start.rotation[spin.body].T
        omega[spin.body] -= axes.T @ (axes @ omega[spin.body])
    start = replace(start, angular_velocity=omega)
    works = any(not load.is_conservative for load in mechanism.loads)
    works = works or bool(mechanism.laws) or bool(mechanism.blows or mechanism.stops)
    works = works or any(j.restitution is not None for j in mechanism.joints)
    works = works or any(row.restitution is not None for own in mechanism.couplings for row in own.rows)
    return Arrangement(idle, omega, framed(mechanism, start, inertias, size, works, named, drives, tree))


def lacking_inertia(scene: PreparedScene, stages: Stages = ANEW) -> dict[int, Array]:
    """The axes about which a body has no inertia and was lent none, body axes (k, 3), by its place in the tree.

    In a planar scene those of bodies that have none about z.
    """
    layout = scene.layout
    return stages.run(lacking, scene.mechanism, scene.idle, layout.spanning, layout.size)


def lacking(mechanism: Mechanism, idle: tuple[IdleSpin, ...], spanning: Spanning, size: float) -> dict[int, Array]:
    """The same, of the scene's tree and size."""
    order = [h.body for h in spanning.hangs]
    inertia = np.array([body.inertia for body in mechanism.bodies]).reshape(-1, 3, 3)
    for spin in idle:
        inertia[spin.body] += spin.lent
    inertia = inertia[order]
    # most have all of it, which their determinants tell sooner than their moments
    volume = np.einsum("ni,ni->n", inertia[:, 0], cross_rows(inertia[:, 1], inertia[:, 2]))
    found = {}
    for i in np.flatnonzero(volume <= tolerances.SLENDER * np.trace(inertia, axis1=1, axis2=2) ** 3).tolist():
        axes, _ = without_inertia(replace(mechanism.bodies[order[i]], inertia=inertia[i]), size)
        if len(axes) and not (mechanism.planar and np.sum(axes[:, 2] ** 2) < tolerances.ALONG_SQUARED):
            found[i] = axes
    return found
