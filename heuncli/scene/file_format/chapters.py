"""Map each model to the chapter of the manual's page on the format whose table describes its keys."""

from collections.abc import Mapping

from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.format_rolling import RollingEntry

# by heading: the model whose keys the first table below it lists, or the models by type
CHAPTERS: dict[str, type[Entry] | Mapping[str, type[Entry]]] = {
    "Tables": f.TableEntry,
    "Bodies": f.BodyEntry,
    "Shapes": fs.SHAPES,
    "Orientation": fs.Orientation,
    "Piece": f.PieceEntry,
    "Joints": f.JOINTS,
    "Bearing of joints": f.BearingEntry,
    "Initial": {"pin": f.Turning, "slide": f.Sliding, "cylinder": f.TurningAndSliding},
    "Stiffness of joints": f.StiffnessParts,
    "Drives": f.DriveEntry,
    **f.LOADS,
    "Impulses": f.ImpulseEntry,
    "Stops": f.StopEntry,
    "Latches": f.LatchEntry,
    **fc.COUPLINGS,
    "Rolling": RollingEntry,
    "Sections": f.SectionEntry,
    "Properties": f.PropertiesEntry,
    "Analysis": f.AnalysisEntry,
    "Conditions": f.ResultConditionEntry,
    "Expect": f.ExpectEntry,
    "Cases": f.CaseEntry,
}
TOP = "Top level"
# small mappings that are described in the row of the key that holds them
INLINE: dict[type[Entry], tuple[str, str]] = {
    f.GroundEntry: (TOP, "ground"),
    f.FoundationEntry: (TOP, "foundation"),
    f.NearEntry: ("Bodies", "near"),
    f.VelocityInFrame: ("Bodies", "velocity"),
    f.RateInFrame: ("Bodies", "velocity"),
    f.CircleEntry: ("Properties", "circle"),
    f.TubeEntry: ("Properties", "tube"),
    f.RectangleEntry: ("Properties", "rectangle"),
}
