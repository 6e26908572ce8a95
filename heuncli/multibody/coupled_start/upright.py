"""Check wheels at the start: a disc that lies flat on its plane touches it everywhere and cannot roll."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.tree.starts import body_state


def require_upright(mechanism: Mechanism, start: Assembly) -> None:
    """Raise SolveError [does-not-fit] for discs whose axles are normal to their planes at the start."""
    for coupling in mechanism.couplings:
        part = coupling.rows[0].parts[0] if coupling.rows else None  # of a rope they are found later
        if part is None or part.kind != "touches":
            continue
        n, k = body_state(start, part.a)[1] @ part.e, body_state(start, part.b)[1] @ part.g
        across = np.cross(n, k)
        if float(across @ across) <= 1.0 - tolerances.ALONG_SQUARED:
            message = f"the wheel {coupling.name} lies flat on its plane: it touches everywhere and cannot roll"
            hint = "set it upright with its orientation; for a body lying on a plane use three joints of type plane"
            raise SolveError(Problem("does-not-fit", message, hint=hint, entry_path=f"rolling.{coupling.name}"))
