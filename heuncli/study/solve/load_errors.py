"""Estimated errors of loads and energy, by kind: twice the difference between runs, and the rounding of sums.

Errors are the largest over the whole run, asked instants or not; each is relative to the largest that is told of its
kind at the asked instants. A kind's forces are seen against its largest force, or largest moment by its longest arm;
its moments against the largest moment, or largest force times the size of the scene. An arm is as long as the scene, of
the foundation as far as the scene reaches from the point that its moment is taken about.
Drives: torques and thrusts each against their own largest. Energy: against the largest kinetic, or what potential and
work have exchanged, for these have no zero of their own.
Where a kind is nothing but what larger terms leave when they cancel it is none: 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import Action, AppliedLoad, applied_loads, joint_actions, whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates, CarriedStates, body_states
from heuncli.loads.kinetostatics.coordinates import coordinates
from heuncli.loads.kinetostatics.couplings import coupling_actions, coupling_loads, rope_actions
from heuncli.loads.kinetostatics.energy import energy
from heuncli.loads.kinetostatics.foundation import central_axis, total
from heuncli.loads.kinetostatics.joint_axes import in_axes
from heuncli.loads.kinetostatics.reactions import JointLoads, in_plane, joint_loads
from heuncli.motion.integration.diagnosis.off_sheaves import require_on_sheaves
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.size import marks
from heuncli.results.results import Array, Estimate, Mask
from heuncli.results.results_schema import BLOWS, BY_CAUSE, TRAVELS
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.study.model.setup import Setup
from heuncli.study.solve.balance_terms import BalanceTerms
from heuncli.study.solve.error_extents import ESTIMATED, Extent, Weights, lengths, norms, relative
from heuncli.study.solve.motion_errors import TOLD, moved_quantities, turned_apart

CHOSEN_ANEW = 1e-6  # of the largest multiplier: what redundant joints leave open changes by more when rows are chosen
CUTS_AT_ONCE, BLOCK = 200_000, 8  # instants times cuts whose loads are compared together; in whole blocks, as of BLAS


Quantity = tuple[str, Array]  # of couplings: what it is, of UNITS, and values (n, k, 3) or (n, k, 1)
UNITS = {"force": "N", "moment": "N·m", "place": "m", "angle": "rad"}

# Kinds, and the reports that tell something of them: what nobody asks for is not compared.
TOLD_IN = {
    "reactions": {"joints", "foundation"},
    "foundation": {"foundation"},
    "sections": {"sections"},
    "forces": {"forces"},
    "motion": {"motion", "points", "forces", BLOWS},
    "energy": {"energy", BLOWS},
}


class SeenInstants(NamedTuple):
    """What was found of instants on the way to their errors: the bodies' states, and what acts in the joints."""

    states: CarriedStates
    joints: tuple[JointLoads, ...] = ()


class LoadErrors:
    """Collects the differences of a motion's loads and energy between two runs, of the kinds that are asked for."""

    def __init__(
        self, setup: Setup, by_cause: bool = False, weights: Weights = ESTIMATED, *, keeping: bool = False
    ) -> None:
        """keeping: what is found of the instants on the way, which of a whole run would be much."""
        self.keeping = keeping
        self.setup, self.by_cause, self.weights = setup, by_cause, weights
        self.compared = frozenset(kind for kind, told_in in TOLD_IN.items() if told_in & setup.asked.reports)
        self.extents: dict[tuple[str, str], Extent] = {}
        self.last: SeenInstants | None = None  # of the instants that were added last
        self.reach = 0.0  # farthest centre of mass from the point that the foundation's moment is about
        self.asked = self.before = np.zeros(0, dtype=bool)

    def extent(self, kind: str, quantity: str) -> Extent:
        """What is known so far of a quantity of a kind."""
        return self.extents.setdefault((kind, quantity), Extent(self.weights))

    def take(
        self, name: tuple[str, str], values: Array, rounding: Array, terms: Array, more: Array | None = None
    ) -> None:
        """More instants of a quantity: see `Extent.add`."""
        self.extent(*name).add(values, rounding, terms, (self.asked, self.before), more)

    def add(self, several: Recovered, asked: Mask, before: Mask) -> None:
        """More instants, which are asked and which before the horizon; at each the answers of A, then of the others."""
        count = len(several.times) // max(len(asked), 1)
        same = same_rows(several, count) if self.setup.model["redundant"] else np.ones(len(asked), dtype=bool)
        if same.any() and not same.all():
            several, asked, before = several.at(np.repeat(same, count)), asked[same], before[same]
        many = self.at_once(count)
        if many >= len(asked):
            self.add_part(several, asked, before)
            return
        for i in range(0, len(asked), many):
            part = slice(i, i + many)
            self.add_part(several.at(slice(count * i, count * part.stop)), asked[part], before[part])

    def at_once(self, count: int) -> int:
        """How many instants of so many runs are looked at together: cuts may be more than all else at an instant."""
        cuts = sum(len(cuts.side) for cuts in self.setup.cuts)
        return BLOCK * max(1, CUTS_AT_ONCE // (BLOCK * count * cuts + 1))

    def add_part(self, several: Recovered, asked: Mask, before: Mask) -> None:
        """Instants that are answered with the same closure rows in all runs."""
        self.asked, self.before = asked, before
        require_on_sheaves(self.setup.scene.layout, several)
        states = body_states(self.setup.scene.layout, several)
        self.last = SeenInstants(states) if self.keeping else None
        loads = applied_loads(self.setup.scene.mechanism, states, several)
        if self.compared & {"reactions", "foundation", "sections", "forces"}:
            self.add_loads(several, states, loads)
        if "energy" in self.compared:
            self.add_energy(several, states)
        if "motion" in self.compared:
            self.add_motion(several, states)

    def add_loads(self, several: Recovered, states: CarriedStates, loads: Sequence[AppliedLoad]) -> None:
        """Loads of all kinds."""
        joints = joint_loads(self.setup.scene.layout, several, states)
        self.last = SeenInstants(states, tuple(joints)) if self.keeping else None
        terms = BalanceTerms(self.setup, several, states, loads)
        applied = [load.action for load in loads]
        couplings = coupling_loads(self.setup.scene.layout, several, states)
        coupled = coupling_actions(couplings)
        if couplings:
            from heuncli.loads.kinetostatics.flanks import with_flanks  # few scenes have gears

            joints = with_flanks(self.setup.scene.layout, joints, couplings)
        acting = [*applied, *coupled]
        if "reactions" in self.compared:
            coupling_told: Sequence[Quantity] = ()
            if couplings:
                from heuncli.study.solve.coupling_errors import told_of  # few scenes have them

                coupling_told = [*told_of(couplings, applied, self.setup.scene.mechanism.joints, states)]
            self.add_joints([in_axes(load, states, self.setup.asked.axes) for load in joints], coupling_told, terms)
        if "foundation" in self.compared:
            driven = [load for load in joints if load.drive is not None]
            self.add_foundation(states, [*acting, *joint_actions(driven)], terms)
        if self.setup.cuts and "sections" in self.compared:
            self.add_sections(states, [*whole_joint_actions(joints), *acting], terms)
        if "forces" in self.compared:
            self.add_forces(loads, terms)
        if self.by_cause:
            from heuncli.study.solve.share_errors import compared_shares  # few runs ask for them

            pushing = [*applied, *rope_actions(couplings)]
            for kind, name, values, more in compared_shares(self.setup, several, states, pushing, self.compared, terms):
                F, M = (rounding * more for rounding in terms.rounding)
                rounding, of = (M, terms.moment * more) if name == "moment" else (F, terms.force * more)
                self.take((f"{kind} {BY_CAUSE}", name), values, rounding, of)

    def add_forces(self, loads: Sequence[AppliedLoad], terms: BalanceTerms) -> None:
        """Applied loads, and what they put into the bodies."""
        F, M = terms.rounding
        for load in loads:
            self.take(("forces", "N"), load.action.force, F, terms.force)
            self.take(("forces", "N·m"), load.action.moment, M, terms.moment)
            none = np.zeros(len(F))
            self.take(("forces", "W"), load.power, none, terms.force)
            if load.strain is not None:
                self.take(("strains", "m"), load.strain[:, 0], none, none)
                self.take(("strains", "rad"), load.strain[:, 1], none, none)

    def add_motion(self, several: Recovered, states: BodyStates) -> None:
        """Velocities and accelerations: of the bodies, and of points as far from their centres as they reach.

        And what is told of the bodies beside.
        """
        count = len(states.omega) // len(self.asked)

        def apart(values: Array) -> Array:
            own = values[0::count]
            return reduce(np.maximum, [norms(own - values[k::count]) for k in range(1, count)])

        turn, turning = apart(states.omega), apart(states.alpha)
        centripetal = 2.0 * norms(states.omega[0::count]) * turn
        for unit, difference in (
            ("rad/s", turn),
            ("rad/s²", turning),
            ("m/s", apart(states.v_centre) + turn * self.reaches),
            ("m/s²", apart(states.a_centre) + (turning + centripetal) * self.reaches),
        ):
            self.extent("motion", unit).differ(difference.max(axis=1), self.before)
        if any(JOINTS[joint.kind].follows_path for joint in self.setup.scene.mechanism.joints):
            self.add_travels(several, states)
        if "motion" in self.setup.asked.reports:
            turned, vectors = turned_apart(states.R, count)
            self.extent("attitudes", "1").differ(turned, self.before)
            self.extent("rodrigues", "1").differ(vectors[self.asked], self.before[self.asked])
            none = np.zeros(len(states.R))
            for unit, values, rounding in moved_quantities(self.setup.scene.mechanism, states, self.setup.about):
                self.take(("motion", unit), values, rounding, none)

    def add_travels(self, several: Recovered, states: BodyStates) -> None:
        """Travels, some of them along paths: in what the tables of these are over, which need not be their length."""
        none = np.zeros(len(several.times))
        for own in coordinates(self.setup.scene.layout, several, states).values():
            if "travel" in own:
                for name, unit in zip(TRAVELS, ("m", "m/s", "m/s²"), strict=True):
                    self.take(("travels", unit), own[name], none, none)

    @cached_property
    def reaches(self) -> Array:
        """How far each body's marks are from its centre of mass at most, (b,) [m]."""
        bodies = self.setup.scene.mechanism.bodies
        far = [max(float(np.sum(np.square(p - body.center))) for p in marks(body)) for body in bodies]
        return np.asarray(np.sqrt(far))

    def add_joints(self, joints: Sequence[JointLoads], coupled: Sequence[Quantity], terms: BalanceTerms) -> None:
        """Reactions, in the axes in which they are told, those of couplings among them, and drives."""
        F, M = terms.rounding
        if joints:
            self.take(("reactions", "force"), np.stack([x.force for x in joints], axis=1), F, terms.force)
            self.take(("reactions", "moment"), np.stack([x.moment for x in joints], axis=1), M, terms.moment)
        none = np.zeros(len(F))
        if joints and (coupled or any(JOINTS[load.joint.kind].follows_path for load in joints)):
            self.take(("reactions", "place"), np.stack([x.point for x in joints], axis=1), none, none)
        of = {"force": (F, terms.force), "moment": (M, terms.moment), "place": (none, none), "angle": (none, none)}
        for name, values in coupled:
            self.take(("reactions", name), values, *of[name])
        for load in joints:
            if load.drive is not None and load.joint.drive is not None:
                turns = load.joint.drive.quantity == "angle"
                rounding, of = (M, terms.moment) if turns else (F, terms.force)
                self.take(("drives", "torque" if turns else "thrust"), load.drive, rounding, of)

    def add_foundation(self, states: BodyStates, actions: Sequence[Action], terms: BalanceTerms) -> None:
        """Total of the foundation, its elements and the mass effects.

        Of a wheel that rolls the orbital and the spin part err against each other: each is told, so each is compared.
        """
        mechanism, origin = self.setup.scene.mechanism, self.setup.about
        arm = states.centre - origin
        far = np.abs(arm).max(axis=(1, 2))
        self.reach = max(self.reach, float(far.max()))
        moments = terms.moment + far * terms.force
        forces_rounding, moments_rounding = terms.rounding
        inner = [action for action in actions if action.kind != "joint" and action.from_ is not None]
        elements = [on for action in inner if (on := action.on_ground()) is not None]
        whole = total(states, terms.weight - terms.ma, terms.spin, actions, origin)
        self.add_axis(*whole)
        wrenches = [
            ("foundation", *whole),
            ("effects", terms.ma.sum(axis=1), np.sum(cross_rows(arm, terms.ma), axis=1)),
            ("effects", terms.ma.sum(axis=1), terms.spin.sum(axis=1)),
            *(("elements", force, moment) for force, moment, _ in elements),
        ]
        for kind, force, moment in wrenches:
            F, M = in_plane(force, moment) if mechanism.planar else (force, moment)
            self.take((kind, "force"), F, forces_rounding, terms.force)
            self.take((kind, "moment"), M, moments_rounding + far * forces_rounding, moments)

    def add_axis(self, force: Array, moment: Array) -> None:
        """The central axis of the wrench at the asked instants: where there is next to no force it errs by far more."""
        count = len(force) // len(self.asked)
        told = np.repeat(self.asked, count)
        axis = central_axis(force[told], moment[told], self.setup.about, 0.0)
        for unit, values in (("1", axis["direction"]), ("m", axis["point"]), ("m", axis["pitch"][:, None])):
            own = values[0::count]
            apart = np.max([norms((own - values[k::count])[:, None])[:, 0] for k in range(1, count)], axis=0)
            self.extent("axis", unit).differ(np.nan_to_num(apart), self.before[self.asked])

    def add_sections(self, states: BodyStates, actions: Sequence[Action], terms: BalanceTerms) -> None:
        """The cuts' loads in body axes, and how far the bodies themselves have turned between the two runs."""
        from heuncli.loads.kinetostatics.sections import acceleration_matrix, attachments, piece_loads  # as in recover

        gravity = self.setup.scene.mechanism.gravity
        for cuts in self.setup.cuts:
            on = attachments(cuts.body, states, actions)
            force, moment = piece_loads(cuts, acceleration_matrix(cuts.body, states, gravity), on)
            R = states.R[:, cuts.body]
            count = len(R) // len(self.asked)
            own = R[0::count]
            turned = reduce(
                np.maximum, [np.sqrt(np.sum((own - R[k::count]) ** 2, axis=(1, 2))) for k in range(1, count)]
            )
            F, M = terms.rounding
            for quantity, values, rounding, of in (
                ("force", force, F, terms.force), ("moment", moment, M, terms.moment),
            ):  # fmt: skip
                both = values.transpose(1, 2, 0)
                turn = turned * lengths(both[0::count])
                self.take(("sections", quantity), both, rounding, of, turn)

    def add_energy(self, several: Recovered, states: BodyStates) -> None:
        """Kinetic and potential energy, and work."""
        block = energy(self.setup.scene.layout, several, states)
        m = np.array([b.mass for b in self.setup.scene.mechanism.bodies])
        speed = np.abs(states.v_centre).max(axis=(1, 2))
        lift = np.abs(states.centre @ self.setup.scene.mechanism.gravity) @ m
        rounding = tolerances.SUM_ROUNDING * (block["kinetic"] + m.sum() * speed**2)
        none = np.zeros(len(several.times))
        self.take(("energy", "kinetic"), block["kinetic"], rounding, none)
        self.take(("energy", "potential"), block["potential"], tolerances.SUM_ROUNDING * lift, none)
        self.take(("energy", "work"), block["work"], none, none)

    def estimate(self) -> Estimate:
        """The estimated error of each kind that is asked for, relative to the largest told of it."""
        size, found = self.setup.scene.layout.size, Estimate()
        if "reactions" in self.compared:
            found["reactions"] = self.wrench(size, "reactions")
            found["drives"] = max(self.wrench(1.0, "drives", "thrust", ""), self.wrench(1.0, "drives", "", "torque"))
        if "foundation" in self.compared:
            found["foundation"] = self.wrench(size + self.reach, "foundation", also=("effects", "elements"))
        if "sections" in self.compared:
            found["sections"] = self.wrench(size, "sections")
        if "energy" in self.compared:
            found["energy"] = self.energies()
        return found

    def errors(self) -> dict[tuple[str, str], float]:
        """The estimated errors by kind and unit, before the horizon."""
        of = {name: extent.claimed_error for name, extent in self.extents.items()}
        found = {
            name: error for name, error in of.items() if name[0] in (*TOLD, "forces", "strains", "travels", "axis")
        }
        whole = ("foundation", "effects", "elements")
        for kind, parts in (("reactions", ("reactions",)), ("sections", ("sections",)), ("foundation", whole)):
            for quantity, unit in (("force", "N"), ("moment", "N·m")):
                found[kind, unit] = max(of.get((part, quantity), 0.0) for part in parts)
        found |= {("reactions", UNITS[x]): of["reactions", x] for x in ("place", "angle") if ("reactions", x) in of}
        found["drives", "N"], found["drives", "N·m"] = (of.get(("drives", x), 0.0) for x in ("thrust", "torque"))
        found["energy", "J"] = max(of.get(("energy", name), 0.0) for name in ("kinetic", "potential", "work"))
        return found | self.errors_by_cause()

    def errors_by_cause(self) -> dict[tuple[str, str], float]:
        """The estimated errors of shares by cause, by kind and unit, before the horizon."""
        units = {"force": "N", "moment": "N·m"}
        known = {name: extent for name, extent in self.extents.items() if name[0].endswith(BY_CAUSE)}
        return {(kind, units[name]): extent.claimed_error for (kind, name), extent in known.items()}

    def wrench(
        self, arm: float, kind: str, force: str = "force", moment: str = "moment", also: Sequence[str] = ()
    ) -> float:
        """Error of forces and of moments, and of those of other kinds; arm: the longest of a moment."""
        if not also and not {(kind, force), (kind, moment)} & self.extents.keys():
            return 0.0
        size = self.setup.scene.layout.size
        F, M = self.extent(kind, force), self.extent(kind, moment)
        parts = [(F, M), *((self.extent(other, force), self.extent(other, moment)) for other in also)]
        terms_F, terms_M = max(f.terms for f, _ in parts), max(m.terms for _, m in parts)
        forces = [max(F.told, M.told / arm), *(max(f.largest, m.largest / arm) for f, m in parts)]
        moments = [max(M.told, F.told * size), *(max(m.largest, f.largest * size) for f, m in parts)]
        return max(
            relative(max(f.error for f, _ in parts), max(terms_F, terms_M / arm), *forces),
            relative(max(m.error for _, m in parts), max(terms_M, terms_F * size), *moments),
        )

    def energies(self) -> float:
        """Error of the energies."""
        mechanism, size = self.setup.scene.mechanism, self.setup.scene.layout.size
        kinetic, potential, work = (self.extent("energy", name) for name in ("kinetic", "potential", "work"))
        lift = sum(b.mass for b in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * size
        if kinetic.largest <= tolerances.NO_ENERGY * lift:
            return 0.0
        error = max(x.error for x in (kinetic, potential, work))
        told = max(kinetic.told, potential.exchanged, work.exchanged)
        return relative(error, kinetic.largest, told, kinetic.largest)

    def kinetic(self) -> float:
        """The largest kinetic energy over the run [J]."""
        return self.extent("energy", "kinetic").largest


def same_rows(several: Recovered, count: int) -> Mask:
    """Where all of so many runs are answered with the same closure rows, (n,): the others have no multiplier.

    One that is nought in one run and next to nothing in another is chosen in both.
    """
    size = np.abs(several.rows["multiplier"])
    none, own = size == 0.0, slice(0, None, count)
    same = np.ones(len(several.times) // count, dtype=bool)
    for k in range(1, count):
        other = slice(k, None, count)
        larger = np.maximum(size[own], size[other])
        much = larger > CHOSEN_ANEW * larger.max(axis=1, initial=0.0)[:, None]
        same &= ~((none[own] != none[other]) & much).any(axis=1)
    return same
