"""Prepare a mechanism to run with its couplings satisfied: multibody/tree/prepare.py, extended by couplings."""

from __future__ import annotations

from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.stages import NO_CACHE, Stages
from heuncli.multibody.tree.prepare import PreparedScene, prepare


def prepare_coupled(mechanism: Mechanism, t0: float = 0.0, stages: Stages = NO_CACHE) -> PreparedScene:
    """Assemble at t0 and lay out. Raises SolveError as `prepare`, and where couplings contradict each other or what is
    held.
    """
    if not mechanism.couplings:
        return prepare(mechanism, t0, stages)
    from heuncli.multibody.coupled_start.lifts import require_lifts
    from heuncli.multibody.coupled_start.start import find_start_rows, fit_start  # few scenes have couplings
    from heuncli.multibody.coupled_start.upright import require_upright

    def with_couplings(scene: PreparedScene) -> PreparedScene:
        require_upright(mechanism, scene.start)
        if any(coupling.entry.type == "cam" for coupling in mechanism.couplings):
            from heuncli.multibody.tree.cam_flanks import require_flanks  # few scenes have them

            require_flanks(scene.layout)
            require_lifts(scene.layout, t0)
        return fit_start(scene, t0, find_start_rows(scene))

    return prepare(mechanism, t0, stages, with_couplings)
