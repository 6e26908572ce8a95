"""Decide whether a motion follows from the drives alone, so that it is solved instant by instant instead of integrated.

This is so where the drives and the closed chains leave no freedom.
"""

from __future__ import annotations

from heuncli.base.records import record
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.multibody.tree.held_speeds import find_speed_rows
from heuncli.results.results import Block

BY_DRIVES = "motion fully prescribed: solved at each instant, nothing integrated"
BY_JOINTS = "nothing can move: the joints leave 0 degrees of freedom, nothing integrated"
SINGULAR = "integrated despite 0 degrees of freedom: the motion passes a singular position, such as a dead centre"
CONTACTS = "integrated despite 0 degrees of freedom: a contact may open or a rope slacken"
ROLLS = "integrated despite 0 degrees of freedom: rolling determines speeds at each instant, not positions"


@record
class DeterminedMotion:
    """The decision whether every instant follows from the drives.

    notes: sentences that state this, or explain why not where a reader might expect it
    """

    is_determined: bool
    notes: tuple[str, ...]

    def add_to_block(self, block: Block) -> Block:
        """Add the notes to the block `model`, next to those on reductions that were made or not made."""
        key = "reduced" if self.is_determined else "not_reduced"
        return block | ({key: [*block.get(key, ()), *self.notes]} if self.notes else {})


NOT_DETERMINED = DeterminedMotion(False, ())


def find_determined_motion(integrated_scene: IntegratedScene) -> DeterminedMotion:
    """Decide whether the motion can be followed from its start without integration.

    Redundantly closed chains may leave no freedom either. A singular start leaves one, so such a motion is integrated.
    """
    layout = integrated_scene.layout
    free = layout.tree_freedoms
    if free > len(layout.rows):
        return NOT_DETERMINED
    freedoms_left = free - integrated_scene.workspace.count_independent_rows(0.0, layout.y0) if layout.rows else free
    if freedoms_left:
        return NOT_DETERMINED
    if len(layout.tables["contacts"]):
        return DeterminedMotion(False, (CONTACTS,))
    if find_speed_rows(layout).any():
        return DeterminedMotion(False, (ROLLS,))
    return DeterminedMotion(True, (BY_DRIVES if layout.has_laws else BY_JOINTS,))


def note_fallback_to_integration(model: Block) -> Block:
    """Correct the block `model` after a motion could not be followed to its end and was integrated."""
    sentences = [sentence for sentence in model.get("reduced", ()) if sentence not in (BY_DRIVES, BY_JOINTS)]
    return {"reduced": sentences, "not_reduced": [*model.get("not_reduced", ()), SINGULAR]}
