"""Couplings: of joints that there are and that have the coordinates which are coupled."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.joint_kinds import TYPES, named
from heuncli.nearest import did_you_mean
from heuncli.spec.rules.registry import DraftDocument, Violation, rule


@rule("coupled-joint")
def coupled_joint(draft: DraftDocument) -> Iterator[Violation]:
    """What is coupled are joints with coordinates, each once."""
    joints = draft.names.joints
    for name, coupling in draft.document.couplings.items():
        for i, joint in enumerate(coupling.of):
            path = ("couplings", name, "of", i)
            if joint not in joints:
                yield Violation(path, f"'{joint}' is not a joint", did_you_mean(joint, joints, "joints") or "")
                continue
            kind = TYPES.get(joints[joint])
            if kind is not None and not kind.coordinates:
                able = named([kind for kind in TYPES.values() if kind.coordinates], "and")
                yield Violation(path, f"a {kind.name} has no coordinate", f"couplings are of {able}")
            if joint in coupling.of[:i]:
                yield Violation(path, f"{joint} is coupled to itself", "name another joint")


@rule("coupling-terms")
def coupling_terms(draft: DraftDocument) -> Iterator[Violation]:
    """A linear relation has a factor for each joint, none of them zero, and two joints at least."""
    for name, coupling in draft.document.couplings.items():
        if len(coupling.factors) != len(coupling.of) or len(coupling.of) < 2:
            message = f"{len(coupling.of)} joints with {len(coupling.factors)} factors"
            yield Violation(("couplings", name, "factors"), message, "two joints at least, and a factor for each")
        for i, factor in enumerate(coupling.factors):
            if factor == 0.0:
                hint = "leave out the joint, or give its factor"
                yield Violation(("couplings", name, "factors", i), "a factor of zero couples nothing", hint)
