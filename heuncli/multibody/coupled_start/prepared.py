"""A mechanism made ready to run with its couplings met: what multibody/tree/prepare.py does, which knows none."""

from __future__ import annotations

from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.prepare import PreparedScene, prepare


def prepare_coupled(mechanism: Mechanism, t0: float = 0.0, stages: Stages = ANEW) -> PreparedScene:
    """Assemble at t0 and lay out. Raises SolveError as `prepare`, and where couplings contradict what is held,
    or cannot be.
    """
    if not mechanism.couplings:
        return prepare(mechanism, t0, stages)
    from heuncli.multibody.coupled_start.lifts import require_lifts
    from heuncli.multibody.coupled_start.start import asked_of, fitted  # few scenes have couplings
    from heuncli.multibody.coupled_start.upright import require_upright

    def with_couplings(scene: PreparedScene) -> PreparedScene:
        require_upright(mechanism, scene.start)
        if any(coupling.given.type == "cam" for coupling in mechanism.couplings):
            from heuncli.multibody.tree.cam_flanks import require_flanks  # few scenes have them

            require_flanks(scene.layout)
            require_lifts(scene.layout, t0)
        return fitted(scene, t0, asked_of(scene))

    return prepare(mechanism, t0, stages, with_couplings)
