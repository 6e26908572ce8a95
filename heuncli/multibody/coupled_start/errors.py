"""Errors where couplings contradict what is held at the start."""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices


def poses_do_not_fit(layout: Layout, rows: Indices, gaps: Array) -> SolveError:
    """Make the error for the worst of some closure rows; gaps: of each row [m]."""
    name, entry_path, bodies = _describe_owner(layout, rows, gaps)
    largest = _format_largest(layout, rows, gaps)
    message = f"{name} cannot be satisfied at the start: an error of {largest} remains between {bodies}"
    hint = "prescribe fewer start values (initial, position, orientation), or change its values"
    return SolveError(Problem("does-not-fit", message, hint=hint, entry_path=entry_path))


def rates_do_not_fit(layout: Layout, rows: Indices, residuals: Array) -> SolveError:
    """Make the error for the worst of some closure rows; residuals: of the rate of each row [m/s]."""
    name, entry_path, bodies = _describe_owner(layout, rows, residuals)
    largest = _format_largest(layout, rows, residuals)
    message = f"{name}: the start velocities of {bodies} are incompatible by {largest}/s"
    hint = "prescribe fewer velocities, or drive fewer coordinates; heun computes the others from the couplings"
    return SolveError(Problem("rates-do-not-fit", message, hint=hint, entry_path=entry_path))


def too_many(layout: Layout, row: int, bodies: int) -> SolveError:
    """Make the error for a coupling row that ties more bodies together than are fitted at once."""
    name, entry_path, _ = _describe_owner(layout, np.array([row]), np.ones(1))
    message = f"{name} connects {bodies:,} bodies whose start does not fit: too many to fit at once"
    return SolveError(Problem("too-many-together", message, hint="give more of its velocities", entry_path=entry_path))


def _describe_owner(layout: Layout, rows: Indices, residuals: Array) -> tuple[str, str, str]:
    """Describe the owner of the row with the largest residual: in words, as the path of its entry, and its bodies."""
    mechanism = layout.mechanism
    k = layout.rows[int(rows[int(np.argmax(np.abs(residuals)))])]
    joints = len(mechanism.joints)
    if k < joints:
        joint = mechanism.joints[k]
        what, bodies = f"joint {joint.name} ({joint.kind})", {joint.a, joint.b}
    else:
        coupling = mechanism.couplings[k - joints]
        what, bodies = f"coupling {coupling.name} ({coupling.entry.type})", set(coupling.bodies)
    if len(bodies) == 1:  # a coupling lists no ground
        bodies.add(GROUND)
    names = [_name(mechanism, i) for i in sorted(bodies, reverse=True)]
    return what, mechanism.owner_path(k), " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _format_largest(layout: Layout, rows: Indices, residuals: Array) -> str:
    """Format the largest residual in its unit: rad for a row of angles, whose gaps count by the scene's size."""
    k = int(np.argmax(np.abs(residuals)))
    r, joints = int(rows[k]), len(layout.mechanism.joints)
    coupling = layout.mechanism.couplings[layout.rows[r] - joints] if layout.rows[r] >= joints else None
    if coupling is None or coupling.rows[r - layout.rows.index(layout.rows[r])].weight:
        return f"{abs(residuals[k]):.3g} m"
    return f"{abs(residuals[k]) / layout.size:.3g} rad"


def _name(mechanism: Mechanism, body: int) -> str:
    return "ground" if body == GROUND else mechanism.bodies[body].name
