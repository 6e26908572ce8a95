"""A spec made ready to run: built, assembled, laid out; what has no inertia to turn with set aside."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.assembly.assemble import assemble
from heuncli.mechanism.build import build, forms_of
from heuncli.mechanism.model import Assembly, Mechanism, PairLoad
from heuncli.mechanism.size import size_of_scene
from heuncli.tree.idle_spins import IdleSpin, idle_spins
from heuncli.tree.layout import Layout
from heuncli.tree.pack import lay_out

if TYPE_CHECKING:
    from heuncli.kinetostatics.cuts import Cuts


@dataclass(frozen=True, eq=False)
class Scene:
    """A spec made ready to run."""

    mechanism: Mechanism
    start: Assembly
    idle: tuple[IdleSpin, ...]
    layout: Layout
    cuts: tuple[Cuts, ...]


def prepare(spec: Any) -> Scene:
    """Build, assemble and lay out.

    Raises SpecError for a section that cannot be cut, SolveError where the scene does not close.
    """
    mechanism, cuts = drawn(spec)
    start = assemble(mechanism, spec.analysis.times[0] if spec.analysis.type == "state" else 0.0)
    return arranged(mechanism, start, cuts)


def drawn(spec: Any) -> tuple[Mechanism, tuple[Cuts, ...]]:
    """The bodies as they are drawn, and their sections. Raises SpecError with every section that cannot be cut."""
    forms = forms_of(spec)
    mechanism = build(spec, forms)
    if not spec.sections:
        return mechanism, ()
    from heuncli.kinetostatics.cuts import lay_cuts  # with the shapes 9 ms that other scenes do not need

    return mechanism, lay_cuts(mechanism, spec, forms)


def arranged(mechanism: Mechanism, start: Assembly, cuts: tuple[Cuts, ...] = ()) -> Scene:
    """Lay out an assembled mechanism; bodies with an undetermined spin get some inertia and no spin about its axis."""
    idle = tuple(idle_spins(mechanism, size_of_scene(mechanism, start)))
    inertias = np.array([b.inertia for b in mechanism.bodies])
    omega = start.angular_velocity.copy()
    for spin in idle:
        inertias[spin.body] += spin.lent
        axes = spin.axes @ start.rotation[spin.body].T
        omega[spin.body] -= axes.T @ (axes @ omega[spin.body])
    start = replace(start, angular_velocity=omega)
    works = any(not isinstance(f, PairLoad) or f.value is not None or f.damping != 0.0 for f in mechanism.loads)
    driven = any(j.drive is not None for j in mechanism.joints)
    return Scene(mechanism, start, idle, lay_out(mechanism, start, inertias, work=works or driven), cuts)
