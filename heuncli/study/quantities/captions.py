"""Words for the quantities of the results: what a client reads in place of a path.

`joints.main.radial` is "main, radial force"; with a label "Main bearing" it is "Main bearing, radial force".
"""

from __future__ import annotations

from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.labels import Labels

# Quantity -> its words, where these are not the quantity's own name with blanks.
WORDS = {
    "angle": "angle", "axial": "axial force", "center": "centre of mass", "center_acceleration": "acceleration",
    "center_velocity": "velocity", "M": "bending moment", "M1": "bending moment M1", "M2": "bending moment M2",
    "N": "axial force N", "Q": "shear force", "Q1": "shear force Q1", "Q2": "shear force Q2", "radial": "radial force",
    "T": "torsion", "tilting": "tilting moment", "turning": "rotation angle", "value": "load",
}  # fmt: skip
VECTORS = {"force": "F", "moment": "M"}  # quantity -> symbol with which its components begin


def describe_path(path: str, labels: Labels) -> str:
    """Describe a path of the results in words: the object's label or name, a comma, and the quantity.

    path: as `--measure` takes it, without a reducer, such as `joints.main.force.x`
    """
    kind, *words = path.split(".")
    component = ""
    if len(words) > 1 and (words[-1] in XYZ or words[-1].isdecimal()):
        *words, component = words
    if not words:
        return kind.replace("_", " ")
    *name, quantity = words
    object_name = describe_object(kind, ".".join(name), labels)
    text = WORDS.get(quantity, quantity.replace("_", " "))
    if component in XYZ:
        text = f"{VECTORS[quantity]}{component}" if quantity in VECTORS else f"{text} {component}"
    elif component:
        text = f"{text} at cut {component}"
    return f"{object_name}, {text}" if object_name else text


def describe_object(kind: str, name: str, labels: Labels) -> str:
    """Return the words for a named thing of a scene: its label, else its name; for a block without names its kind."""
    return name.replace("supports.", "support ", 1).replace("_", " ") if name else kind.replace("_", " ")
