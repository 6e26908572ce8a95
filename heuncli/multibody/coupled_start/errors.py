"""What is said where couplings and what is held at the start contradict each other."""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices


def poses_do_not_fit(layout: Layout, rows: Indices, left: Array) -> SolveError:
    """left: the gap [m] of each of some closure rows; the worst is told."""
    name, about, bodies = _owner(layout, rows, left)
    message = f"{name} cannot be met by the start: {_most(layout, rows, left)} stay open between {bodies}"
    hint = "hold fewer values (initial, position, orientation); or change its numbers"
    return SolveError(Problem("does-not-fit", message, hint=hint, about=about))


def rates_do_not_fit(layout: Layout, rows: Indices, left: Array) -> SolveError:
    """left: what the rate [m/s] of each of some closure rows lacks; the worst is told."""
    name, about, bodies = _owner(layout, rows, left)
    most = _most(layout, rows, left)
    message = f"{name}: the start velocities of {bodies} differ there by {most}/s more than it allows"
    hint = "hold fewer velocities, or drive fewer coordinates; what is left out follows the couplings"
    return SolveError(Problem("rates-do-not-fit", message, hint=hint, about=about))


def too_many(layout: Layout, row: int, bodies: int) -> SolveError:
    """More bodies than are fitted at once hang together by the coupling of a row."""
    name, about, _ = _owner(layout, np.array([row]), np.ones(1))
    message = f"{name} ties {bodies:,} bodies together whose start does not fit yet: more than are fitted at once"
    return SolveError(Problem("too-many-together", message, hint="give more of its velocities", about=about))


def _owner(layout: Layout, rows: Indices, left: Array) -> tuple[str, str, str]:
    """Who asks for the row with most left: in words, as the path of its entry, and its bodies."""
    mechanism = layout.mechanism
    k = layout.rows[int(rows[int(np.argmax(np.abs(left)))])]
    joints = len(mechanism.joints)
    if k < joints:
        joint = mechanism.joints[k]
        what, bodies = f"joint {joint.name} ({joint.kind})", {joint.a, joint.b}
    else:
        coupling = mechanism.couplings[k - joints]
        what, bodies = f"coupling {coupling.name} ({coupling.given.type})", set(coupling.bodies)
    if len(bodies) == 1:  # a coupling lists no ground
        bodies.add(GROUND)
    names = [_name(mechanism, i) for i in sorted(bodies, reverse=True)]
    return what, mechanism.owner(k), " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _most(layout: Layout, rows: Indices, left: Array) -> str:
    """The largest of what is left, in its unit: rad of a row of angles, whose gaps count by the scene's size."""
    k = int(np.argmax(np.abs(left)))
    r, joints = int(rows[k]), len(layout.mechanism.joints)
    coupling = layout.mechanism.couplings[layout.rows[r] - joints] if layout.rows[r] >= joints else None
    if coupling is None or coupling.rows[r - layout.rows.index(layout.rows[r])].weight:
        return f"{abs(left[k]):.3g} m"
    return f"{abs(left[k]) / layout.size:.3g} rad"


def _name(mechanism: Mechanism, body: int) -> str:
    return "ground" if body == GROUND else mechanism.bodies[body].name
