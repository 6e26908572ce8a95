"""Whether a motion is followed and not integrated: where the drives and the closed chains leave no freedom."""

from __future__ import annotations

from heuncli.base.records import record
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.multibody.tree.held_speeds import holds_speed
from heuncli.results.results import Block

BY_DRIVES = "nothing is integrated: the drives leave no freedom, every instant follows from them and what closes chains"
BY_JOINTS = "nothing is integrated: the joints leave no freedom, nothing can move"
SINGULAR = "integrated, though the drives leave no freedom: on the way lies a singular pose, as a dead centre is"
CONTACTS = "integrated, though nothing is free: a rope or a stop may open and close"
ROLLS = "integrated, though nothing is free: what rolls has its speeds determined at each instant, and no pose"


@record
class Determined:
    """Whether every instant follows from the drives; told: that, or why not though a reader might expect it."""

    is_so: bool
    told: tuple[str, ...]

    def beside(self, block: Block) -> Block:
        """This told beside what else was reduced, or was not: sentences by their keys in the block `model`."""
        key = "reduced" if self.is_so else "not_reduced"
        return block | ({key: [*block.get(key, ()), *self.told]} if self.told else {})


NOT_DETERMINED = Determined(False, ())


def determined(moving: IntegratedScene) -> Determined:
    """Whether a motion can be followed from its start.

    Closed chains that are held more than once leave no freedom as well; a singular start does, and is integrated.
    """
    layout = moving.layout
    free = layout.tree_freedoms
    if free > len(layout.rows):
        return NOT_DETERMINED
    left = free - moving.workspace.chosen_count(0.0, layout.y0) if layout.rows else free
    if left:
        return NOT_DETERMINED
    if len(layout.tables["contacts"]):
        return Determined(False, (CONTACTS,))
    if holds_speed(layout).any():
        return Determined(False, (ROLLS,))
    return Determined(True, (BY_DRIVES if layout.driven else BY_JOINTS,))


def integrated_after_all(model: Block) -> Block:
    """What the note on the model tells of a motion that could not be followed to its end."""
    kept = [sentence for sentence in model.get("reduced", ()) if sentence not in (BY_DRIVES, BY_JOINTS)]
    return {"reduced": kept, "not_reduced": [*model.get("not_reduced", ()), SINGULAR]}
