"""What follows from the kernel's answers at some instants: places, reactions, verdicts, applied loads, shares, energy.

Reads as the list of what is computed; each thing has its own module. Raises SolveError where no acceleration exists.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action, AppliedLoad, applied_loads, joint_actions, whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.couplings import CouplingLoads, coupling_actions, coupling_loads, rope_actions
from heuncli.loads.kinetostatics.energy import energy
from heuncli.loads.kinetostatics.magnitudes import inertia_scale, magnitudes, magnitudes_of_loads
from heuncli.loads.kinetostatics.reactions import JointLoads, at_instants, joint_loads
from heuncli.motion.integration.diagnosis.off_sheaves import require_on_sheaves
from heuncli.motion.integration.diagnosis.solvability import require_directions, require_solvable
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import PairLoad
from heuncli.results.results import Array, Block, CertainSum, Magnitudes, Mask
from heuncli.results.results_schema import BLOWS, SHARED
from heuncli.study.model.setup import Setup
from heuncli.study.solve.load_errors import SeenInstants

if TYPE_CHECKING:  # loaded where a scene has closed chains, or sections, or loads are told by cause
    from heuncli.loads.kinetostatics.shares import Shares
    from heuncli.loads.redundancy.resolve import Resolution
    from heuncli.loads.redundancy.self_stress import SelfStress


HUNG_ON_RANK = SHARED  # reports that ask for the rank of the closures
OF_ENERGY = frozenset({"energy", BLOWS})  # reports that tell energies
WITHOUT_VERDICTS = frozenset({"states", "unsplit", "loads", "energy", "inertia"})  # what is open has no say in them
WITHOUT_CUTS = WITHOUT_VERDICTS | {"decided", "shares"}


@record
class Recovery:
    """What follows from the kernel's answers at some instants; each thing is computed when it is first asked for.

    given: actions from outside that are no loads of the mechanism: the impulses of blows. causes: the names of the
    kernel's columns, where these are not those of the mechanism. told: what is open at these instants is told
    elsewhere, by what it is on either side of each (study/search/open_between.py), and not looked for. compared: of one
    instant and another beside it, what is known of them before.
    """

    setup: Setup
    recovered: Recovered
    least_norm: bool
    given: tuple[Action, ...] = ()
    causes: tuple[str, ...] | None = None
    told: bool = False
    compared: SeenInstants | None = None

    def with_cuts(self, setup: Setup) -> Recovery:
        """The same of the scene with other cuts; what was computed stays."""
        return self._sharing(replace(self, setup=setup), WITHOUT_CUTS)

    def at(self, which: Mask) -> Recovery:
        """At some of the instants."""
        found: Recovery = replace(self, recovered=self.recovered.at(which), compared=None)
        return found

    def as_told(self) -> Recovery:
        """The same without a look for what is open; what was computed stays."""
        return self._sharing(replace(self, told=True), WITHOUT_VERDICTS)

    def _sharing(self, other: Recovery, names: frozenset[str]) -> Recovery:
        other.__dict__.update({name: value for name, value in self.__dict__.items() if name in names})
        return other

    @cached_property
    def states(self) -> BodyStates:
        """Places, velocities and accelerations of the bodies."""
        if self.compared is not None:
            return self.compared.states.at(slice(0, len(self.recovered.times)))
        return body_states(self.setup.scene.layout, self.recovered, self.setup.steady)

    @cached_property
    def decided(self) -> Resolution | None:
        """What redundant joints leave open, after the split that was asked for; None without closed chains."""
        layout = self.setup.scene.layout
        if not layout.rows:
            return None
        from heuncli.loads.redundancy.resolve import Resolution, resolve  # a tree starts faster without it

        if self.told:
            return self.flanked(Resolution(self.unsplit))
        setup = self.setup
        return self.flanked(
            resolve(setup.runner, self.recovered, self.states, self.unsplit, self.least_norm, setup.known)
        )

    def flanked(self, found: Resolution) -> Resolution:
        """With what holds the flanks of couplings together, after the split."""
        layout = self.setup.scene.layout
        if not layout.mechanism.couplings:
            return found
        from heuncli.loads.kinetostatics.flanks import with_flanks  # few scenes have gears
        from heuncli.loads.redundancy.open_flanks import with_open_flanks

        couplings = self.couplings_of(found)
        left, stress = (
            None if own is None else with_open_flanks(own, layout, found.joints, couplings)
            for own in (found.left, found.stress)
        )
        return replace(found, joints=with_flanks(layout, found.joints, couplings), left=left, stress=stress)

    @property
    def verdicts(self) -> bool:
        """Whether it matters what redundant joints leave open: to what is asked for, or to how joints are split."""
        setup = self.setup
        may_share = bool(setup.model["redundant"] or setup.scene.layout.contacts)
        return may_share or bool(HUNG_ON_RANK & setup.asked.reports)

    @cached_property
    def joints(self) -> list[JointLoads]:
        """The joints' reactions."""
        if self.decided is not None:
            return self.decided.joints
        return self.unsplit

    @cached_property
    def asked_joints(self) -> list[JointLoads]:
        """The reactions of the joints that are asked for, or that a stop which is asked for stands in."""
        asked, decided = self.setup.asked, self.decided
        every = "joints" not in asked.partial or BLOWS in asked.reports  # of a blow all is told
        if every or (decided is not None and decided.marks):
            return self.joints
        mechanism = self.setup.scene.mechanism
        stopped = {mechanism.joints[stop.joint].name for stop in mechanism.stops if stop.name in asked.of("stops")}
        names = asked.of("joints") | stopped
        if decided is not None or self.compared is not None or "unsplit" in self.__dict__:
            return [load for load in self.joints if load.joint.name in names]
        return joint_loads(self.setup.scene.layout, self.recovered, self.states, names)

    @cached_property
    def unsplit(self) -> list[JointLoads]:
        """The joints' reactions as the kernel answers them: where some are redundant, one split of many."""
        if self.compared is not None and self.compared.joints:
            return at_instants(self.compared.joints, slice(0, len(self.recovered.times)), self.states)
        return joint_loads(self.setup.scene.layout, self.recovered, self.states)

    @cached_property
    def couplings(self) -> list[CouplingLoads]:
        """What couplings exert."""
        return self.couplings_of(self.decided) if self.setup.scene.mechanism.couplings else []

    def couplings_of(self, decided: Resolution | None) -> list[CouplingLoads]:
        """What they exert after a split."""
        more = decided.more if decided is not None else None
        found = coupling_loads(self.setup.scene.layout, self.recovered, self.states)
        return [own.plus(more).rubbing(self.applied) for own in found]

    @cached_property
    def loads(self) -> list[AppliedLoad]:
        """The applied loads; of a spring whose points coincide the rate at which they part: its line begins there."""
        found = applied_loads(self.setup.scene.mechanism, self.states, self.recovered)
        if not any(isinstance(own.load, PairLoad) and (own.length == 0.0).any() for own in found):
            return found
        from heuncli.motion.integration.diagnosis.coincident_points import parting  # hardly any scene needs it

        layout, recovered = self.setup.scene.layout, self.recovered
        return [
            replace(own, rate=np.where(own.length == 0.0, speed(parting(layout, own.load, recovered)), own.rate))
            if isinstance(own.load, PairLoad)
            else own
            for own in found
        ]

    @cached_property
    def shares(self) -> Shares:
        """The joints' loads by their causes, after the same split; of instants that were recovered with causes."""
        from heuncli.loads.kinetostatics.flanks import with_flanks
        from heuncli.loads.kinetostatics.shares import alone, members_of, shares_of  # few runs ask for them

        layout = self.setup.scene.layout
        own = None if self.causes is None else {name: [k] for k, name in enumerate(self.causes)}
        members = members_of(layout.mechanism) if own is None else own
        found = shares_of(layout, self.recovered, self.states, self.pushing, members)
        if self.decided is None:
            return found
        joints, more = self.decided.chosen(found.joints, self.states)
        rubs = [alone(found, action) for action in found.applied]
        couplings = [own.plus(more).rubbing(rubs) for own in found.couplings]
        return replace(found, joints=with_flanks(layout, joints, couplings), couplings=couplings)

    @property
    def applied(self) -> list[Action]:
        """The actions of the applied loads, and of what is given beside them."""
        return [*(load.action for load in self.loads), *self.given]

    @property
    def pushing(self) -> list[Action]:
        """What acts by laws: the same, and ropes that stretch."""
        return [*self.applied, *rope_actions(self.couplings)]

    @cached_property
    def actions(self) -> list[Action]:
        """Everything that acts on the bodies but their weight; of a joint constraint and drive together."""
        may_differ = self.verdicts or self.setup.scene.mechanism.couplings
        joints = whole_joint_actions(self.joints if may_differ else self.unsplit)
        return [*self.applied, *joints, *coupling_actions(self.couplings)]

    @property
    def standing(self) -> list[Action]:
        """The same, of each joint constraint, drive and stops apart: what may stand on the ground."""
        return [*self.applied, *joint_actions(self.joints), *coupling_actions(self.couplings)]

    @cached_property
    def energy(self) -> Block:
        """Kinetic and potential energy, and work."""
        return energy(self.setup.scene.layout, self.recovered, self.states)

    @cached_property
    def magnitudes(self) -> Magnitudes:
        """What the numbers are summed from."""
        scene = self.setup.scene
        energy = self.energy if OF_ENERGY & self.setup.asked.reports else {}
        return magnitudes(scene.mechanism, self.states, self.inertia, self.actions, energy, scene.layout.size)

    @cached_property
    def load_magnitudes(self) -> Magnitudes:
        """As much of them as errors of loads hang on."""
        return magnitudes_of_loads(self.states, self.inertia, self.actions, self.setup.scene.layout.size)

    @cached_property
    def inertia(self) -> Array:
        """The largest inertia load or weight of each body, (n_t, n) [N]."""
        return inertia_scale(self.setup.scene.mechanism, self.states)

    @property
    def generic(self) -> Array:
        """How many self-stresses there are at most at each instant but for a singular pose, (n_t,).

        Those of the start, and one more for each contact that has closed since.
        """
        own = slice(len(self.setup.scene.layout.contacts))
        closed = (self.recovered.holding[:, own] > 0.0) & ~(self.setup.runner.start_holding[own] > 0.0)
        return np.asarray(self.setup.model["redundant"] + closed.sum(axis=1))

    @property
    def indeterminate(self) -> SelfStress | None:
        """The self-stresses that no split has resolved."""
        return self.decided.left if self.decided is not None else None


def speed(velocities: Array) -> Array:
    """The magnitudes of vectors (n_t, 3)."""
    return np.asarray(np.sqrt(np.sum(velocities**2, axis=-1)))


def recover(setup: Setup, recovered: Recovered, least_norm: bool, compared: SeenInstants | None = None) -> Recovery:
    """What follows from the kernel's answers; compared: as there. Raises SolveError where no acceleration exists."""
    if compared is None:  # else it was asked before
        require_solvable(setup.scene, recovered)
        require_on_sheaves(setup.scene.layout, recovered)
        require_directions(setup.scene, recovered)
    found = Recovery(setup, recovered, least_norm, compared=compared)
    if setup.scene.mechanism.rubbing and found.decided is not None:
        from heuncli.loads.redundancy.rubbing import require_certain  # few scenes need it

        require_certain(setup.scene.layout, found.decided.searched, found.states, recovered.times)
    return found


def certain_sums(recovery: Recovery) -> list[CertainSum]:
    """Sums of indeterminate components that are determined."""
    if recovery.decided is None:
        return []
    return recovery.decided.sums(recovery.setup.runner, recovery.recovered, recovery.couplings)
