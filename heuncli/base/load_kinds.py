"""The kinds of loads, one row each: all other code reads the rows, nothing branches on a kind's name.

A row tells where a load acts, by which laws of the kernel, and how it is spoken of, drawn and checked. Three tables
beside it have an entry of the same name for what users write: its keys (scene/file_format/format_loads.py), what these
mean (scene/file_format/resolve_loads.py), and for symbols of its own how they are drawn (output/drawing/symbols.py, and
output/web_page/symbols.js for the page). The spec depends on this module, so it does not import NumPy.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from heuncli.base.named_tuples import NamedTuple

# a point or a line of one body, from outside; along the line between two points; in a joint; where two bodies meet;
# along a rope; on the flanks of a thread
Place = Literal["point", "line", "points", "joint", "bodies", "rope", "thread"]
NO_SAMPLE: Mapping[str, tuple[float, float]] = MappingProxyType({})


class LoadKind(NamedTuple):
    """One kind of load: a row of LOAD_KINDS. Defaults hold for most kinds.

    kernel_laws: names of laws in kernel/scene.py; in a joint of its turning and of its sliding, of a bushing of
    its shift and of its turn
    description: what it is, in the manual
    unit: of its value; None: the joint decides
    has_potential: whether it stores energy that only its place decides; damping may take some
    opposed_motion: the motion that it opposes, in words, if that is all it does
    is_friction: whether what opposes has a size of its own, and a sign that is smoothed
    law_keys, number_keys: keys of its law, and of the numbers that may stand in its place, where it has two forms
    required_keys: of those numbers, the ones without a default
    not_negative: keys whose numbers say how strongly it resists
    symbols: between two points: the symbol, and the one where it is damped, if that is another; in a joint: about an
    axis towards the eye, about one away from it, and along an axis
    synonyms: what it is called elsewhere
    words: its name in sentences, if that is not `name`
    sample: the keys that are numbers alone, with ranges from which random scenes of the tests draw
    """

    name: str
    place: Place
    kernel_laws: tuple[str, ...]
    description: str
    unit: Literal["N", "N·m"] | None = "N"
    has_potential: bool = False
    opposed_motion: str | None = None
    is_friction: bool = False
    law_keys: tuple[str, ...] = ()
    number_keys: tuple[str, ...] = ()
    required_keys: tuple[str, ...] = ()
    not_negative: tuple[str, ...] = ()
    symbols: tuple[str, ...] = ()
    synonyms: tuple[str, ...] = ()
    words: str | None = None
    sample: Mapping[str, tuple[float, float]] = NO_SAMPLE

    @property
    def is_external(self) -> bool:
        """Whether it comes from outside: no other body feels the opposite."""
        return self.place in ("point", "line")

    @property
    def is_in_joint(self) -> bool:
        """Whether it acts in a joint."""
        return self.place == "joint"

    @property
    def depends_on_state(self) -> bool:
        """Whether it depends on positions or velocities even where its values in time do not."""
        return self.has_potential or self.opposed_motion is not None

    @property
    def display_name(self) -> str:
        """Its name in sentences."""
        return self.words or self.name.replace("_", " ")


LOAD_KINDS: dict[str, LoadKind] = {
    kind.name: kind
    for kind in (
        LoadKind("force", "point", ("FORCE",), "a force at a point of a body", synonyms=("load",)),
        LoadKind("couple", "point", ("COUPLE",), "a couple on a body", "N·m", synonyms=("moment",)),
        LoadKind(
            "torque", "joint", ("TORQUE", "THRUST"), "a torque about a pin's axis, or a thrust along a slide's axis",
            None, symbols=("turning", "turning back", "sliding"), synonyms=("thrust",),
        ),
        LoadKind(
            "actuator", "points", ("ACTUATOR",), "a given force along the line between two points",
            symbols=("actuator",), synonyms=("cylinder",),
        ),
        LoadKind(
            "spring", "points", ("SPRING",), "a spring and damper along the line between two points",
            has_potential=True, law_keys=("force",), number_keys=("stiffness", "length", "damping"),
            required_keys=("stiffness", "length"), not_negative=("stiffness", "length", "damping"),
            symbols=("spring", "damped spring"), synonyms=("springdamper", "spring_damper"),
            sample={"stiffness": (1, 10), "length": (0.1, 1), "damping": (0, 1)},
        ),
        LoadKind(
            "turn_spring", "joint", ("TURN_SPRING",), "a torsion spring and damper in a joint", "N·m",
            has_potential=True, law_keys=("torque",), number_keys=("stiffness", "angle", "damping"),
            required_keys=("stiffness",), not_negative=("stiffness", "damping"), symbols=("coil", "coil", "coil"),
            synonyms=(
                "torsion_spring", "torsional_spring", "rotational_spring", "rotary_spring", "angular_spring",
                "spiral_spring",
            ),
            words="torsion spring",
            sample={"stiffness": (1, 10), "angle": (-2, 2), "damping": (0, 1)},
        ),
        LoadKind(
            "distributed", "line", ("FORCE",), "a load along a line on a body",
            synonyms=("line_load", "udl", "uniform", "distributed_load", "line_force"),
        ),
        LoadKind(
            "damper", "joint", ("TURN_DAMPER", "SHIFT_DAMPER"), "resists the motion that a joint leaves free", None,
            opposed_motion="the rate of its joint", law_keys=("torque", "force"),
            number_keys=("coefficient", "sliding"), not_negative=("sliding", "coefficient"),
            symbols=("damping", "damping", "damping"),
            synonyms=("dashpot",),
        ),
        LoadKind(
            "friction", "joint", ("TURN_FRICTION", "SHIFT_FRICTION"), "Coulomb's friction in a joint", None,
            opposed_motion="the rate of its joint", is_friction=True,
            not_negative=("length", "coefficient", "torque", "force"), symbols=("brake", "brake", "brake along"),
            synonyms=("brake", "coulomb"),
        ),
        LoadKind(
            "motor", "joint", ("TORQUE",), "a motor in a pin: torque over speed, through a gear", "N·m",
            not_negative=("limit",), symbols=("turning", "turning back", "sliding"), synonyms=("engine",),
        ),
        LoadKind(
            "bushing", "bodies", ("BUSHING_SHIFT", "BUSHING_TURN"), "six springs and dampers between two bodies",
            has_potential=True, not_negative=("stiffness", "damping", "turning", "turning_damping"),
            symbols=("bushing",), synonyms=("bush", "mount"),
        ),
        # of couplings
        LoadKind("rope", "rope", ("ROPE",), "an elastic rope", has_potential=True),
        LoadKind(
            "thread friction", "thread", ("THREAD_FRICTION",), "friction in a thread", "N·m",
            opposed_motion="the direction of rotation of its thread", is_friction=True,
        ),
    )
}  # fmt: skip
LOAD_SYNONYMS = {word: kind.name for kind in LOAD_KINDS.values() for word in kind.synonyms}
