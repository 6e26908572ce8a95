"""What couplings exert: each condition of two bodies its load, a force and a couple at one place, ON both of them.

The loads are those of the kernel's parts for the multipliers of their rows. World axes; shapes (..., n_t, 3), before
the instants an axis of causes where they are told by cause.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import chain

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action, ActionEnd
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import Answers
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Screw
from heuncli.scene.shapes.rotations import cross_rows


@record
class PartLoad:
    """Force and moment of one part ON its body b, about the place there, the opposite ON a, about its place on a.

    place, place_a (n_t, 3); f, m, m_a (n_t, 3): those for a multiplier of 1, m about the one, m_a about the other.
    pushed (n_t, 3): the force ON b for one of 1 or of -1; None: none.
    """

    part: CouplingPart
    place: Array
    place_a: Array
    f: Array
    m: Array
    m_a: Array
    multiplier: Array
    pushed: Array | None = None

    @property
    def force(self) -> Array:
        """Force ON b."""
        found: Array = self.multiplier[..., None] * self.f
        return found if self.pushed is None else found + self.push

    @property
    def push(self) -> Array:
        """The part of the force ON b that has the same direction whatever the sign of all multipliers together."""
        if self.pushed is None:
            return np.zeros_like(self.multiplier[..., None] * self.f)
        whole = self.multiplier.reshape(-1, len(self.f)).sum(axis=0)
        found: Array = (np.where(whole < 0.0, -1.0, 1.0) * self.multiplier)[..., None] * self.pushed
        return found

    @property
    def moment(self) -> Array:
        """Moment ON b about the place."""
        found: Array = self.multiplier[..., None] * self.m
        return found

    def of_multiplier(self, multiplier: Array) -> PartLoad:
        """The same with another multiplier."""
        return replace(self, multiplier=multiplier)

    @property
    def moment_on_a(self) -> Array:
        """Moment ON a about its place there."""
        found: Array = -self.multiplier[..., None] * self.m_a
        return found

    @property
    def on_both(self) -> Iterator[tuple[int, Array, Array, Array]]:
        """Of b, then of a: the body, the place, the force ON it and the moment about the place."""
        yield self.part.b, self.place, self.force, self.moment
        yield self.part.a, self.place_a, -self.force, self.moment_on_a

    @property
    def ends(self) -> tuple[ActionEnd, ActionEnd]:
        """Where it acts on b and on a: it may move over both."""
        on_b = ActionEnd(self.part.b, self.place, None, apart=True)
        return on_b, ActionEnd(self.part.a, self.place_a, None, apart=True)


@record
class CouplingLoads:
    """What a coupling exerts; multipliers: of its rows, (..., n_t) each.

    A rope that stretches has no row, and its load's value for a multiplier.
    friction: of a thread, by what its row carries. It stands among the applied loads, and is told here with the rest.
    """

    coupling: Coupling
    rows: tuple[int, ...]
    multipliers: tuple[Array, ...]
    parts: tuple[PartLoad, ...]
    friction: Action | None = None

    def rubbing(self, applied: Sequence[Action]) -> CouplingLoads:
        """With its friction, which is among the applied loads by its name."""
        if not isinstance(self.coupling.given, Screw) or self.coupling.given.friction is None:
            return self
        return replace(self, friction=next((own for own in applied if own.name == self.coupling.name), None))

    @property
    def carries(self) -> str:
        """What its load is called: a moment, where it loads by couples alone; of a cam the force of contact."""
        if self.coupling.given.type == "cam":
            return "contact"
        return "moment" if self.coupling.carriers[0].is_couple else "force"

    @property
    def carried(self) -> Array:
        """That load, (..., n_t): the multiplier of the first row; of a cam above zero where it presses."""
        if self.carries != "contact":
            return self.multipliers[0]
        (load,) = self.parts
        size: Array = load.part.factor * np.sqrt(np.sum(load.f * load.f, axis=-1))
        return size * self.multipliers[0]

    def of_multipliers(self, multipliers: Array) -> CouplingLoads:
        """What it would exert with other multipliers of all rows, (..., n_t, rows): by what stretches nothing."""
        own = tuple(multipliers[..., r] for r in self.rows)
        if self.coupling.stretched is not None:
            own = (np.zeros(multipliers.shape[:-1]),)
        if not self.parts:
            return CouplingLoads(self.coupling, self.rows, own, ())
        places = iter(self.parts)
        parts = tuple(
            next(places).of_multiplier(multiplier)
            for row, multiplier in zip(self.coupling.carriers, own, strict=True)
            for _ in row.parts
        )
        return CouplingLoads(self.coupling, self.rows, own, parts)

    def parts_of_rows(self) -> Iterator[tuple[int, PartLoad]]:
        """The parts, each with the closure row that it belongs to."""
        owners = [r for r, row in zip(self.rows, self.coupling.rows, strict=True) for _ in row.parts]
        return zip(owners, self.parts, strict=self.coupling.stretched is None)

    def plus(self, more: Array | None) -> CouplingLoads:
        """With what is added to the multipliers of all rows, (..., n_t, rows); None: nothing."""
        if more is None or self.coupling.stretched is not None:
            return self
        whole = np.zeros_like(more)
        for r, multiplier in zip(self.rows, self.multipliers, strict=True):
            whole[..., r] = multiplier + more[..., r]
        return self.of_multipliers(whole)

    def on_bodies(self, beside: Sequence[Action] = ()) -> dict[int, tuple[Array, Array, Array]]:
        """Of each body that it loads, the ground among them: a place, the force ON it, the moment about the place.

        beside: what it exerts besides, as the pretension of a belt.
        """
        found: dict[int, tuple[Array, Array, Array]] = {}
        loading = (own for own in self.parts if not own.part.counts_alone)
        parts = sorted(loading, key=lambda own: not own.part.lies)  # of sheaves their centres come first
        rubs = () if self.friction is None else (self.friction,)
        held = (on for part in parts for on in part.on_both)
        given = ((end.body, end.position, F, M) for action in (*beside, *rubs) for end, F, M in action.on_bodies())
        for body, place, own, turning in chain(held, given):
            at, force, moment = found.get(body, (place, np.zeros_like(own), np.zeros_like(turning)))
            found[body] = at, force + own, moment + turning + cross_rows(place - at, own)
        return found


def coupling_loads(
    layout: Layout, recovered: Answers, states: BodyStates, only: Collection[str] | None = None
) -> list[CouplingLoads]:
    """The loads of all couplings, in the order of the spec; only: of those of some names."""
    mechanism, found = layout.mechanism, []
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if only is not None and coupling.name not in only:
            continue
        rows = tuple(r for r, k in enumerate(layout.rows) if k == owner)
        multipliers = tuple(recovered.rows["multiplier"][..., r] for r in rows)
        firsts = [int(layout.tables["closures"][r]["part"]) for r in rows]
        if coupling.stretched is not None:
            multipliers, firsts = _pull(layout, coupling.name, recovered)
        parts: list[PartLoad] = []
        for first, row, multiplier in zip(firsts, coupling.carriers, multipliers, strict=False):
            parts += _part_loads(first, row.parts, multiplier, recovered, states)
        found.append(CouplingLoads(coupling, rows, multipliers, tuple(parts)))
    return found


def _pull(layout: Layout, name: str, recovered: Answers) -> tuple[tuple[Array], list[int]]:
    """The value of a rope that stretches, and where its parts begin; none in a blow, in which it does not stretch."""
    k, values = layout.mechanism.row_of_rope(name), recovered.loads["value"]
    if k < 0 or values.shape[-1] <= k:
        return (np.zeros(values.shape[:-1]),), []
    return (values[..., k],), [int(layout.tables["loads"][k]["part"])]


def _part_loads(
    first: int,
    parts: Sequence[CouplingPart],
    multiplier: Array,
    recovered: Answers,
    states: BodyStates,
) -> Iterator[PartLoad]:
    """The loads of the parts of one row, from the first of them on."""
    for k, part in enumerate(parts, first):
        f, m, Q, on_a, on_b = (recovered.parts[name][:, k] for name in ("f", "m", "Q", "on_a", "on_b"))
        if part.on_a is not None:
            on_a = states.point_position(part.c, part.on_a)
        pushed = states.direction(part.c, np.asarray(part.apart)) if np.any(part.apart) else None
        m_a = m + cross_rows(Q - on_a, f)
        yield PartLoad(part, on_b, on_a, f, m + cross_rows(Q - on_b, f), m_a, multiplier, pushed)


def rope_actions(couplings: Sequence[CouplingLoads]) -> list[Action]:
    """What ropes that stretch exert: as loads do, each by a law of its own."""
    return coupling_actions([own for own in couplings if own.coupling.stretched is not None])


def coupling_actions(couplings: Sequence[CouplingLoads]) -> list[Action]:
    """What they exert, an action a part."""
    return [
        Action("coupling", own.coupling.name, *part.ends, part.force, part.moment, opposite=part.moment_on_a)
        for own in couplings
        for part in own.parts
        if not (part.part.lies or part.part.counts_alone)
    ]
