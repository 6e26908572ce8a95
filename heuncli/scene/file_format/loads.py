"""Validated loads of a scene: frozen records, numbers in SI, references resolved; kinds as in base/load_kinds.py.

None marks what the spec leaves out; vectors are tuples of three floats, values in time are expressions (models.py).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, Literal, TypeVar

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.couplings import End as End
from heuncli.scene.file_format.couplings import Vec as Vec

if TYPE_CHECKING:
    pass


Matrix = tuple[Vec, Vec, Vec]
ZERO_MATRIX: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


Vector = tuple[Expression, Expression, Expression]


Frame = Literal["world", "body"]


V = TypeVar("V")  # a vector
M = TypeVar("M")  # a matrix


class PointForce(NamedTuple):
    """A force at a point of a body [N]."""

    on: End
    vector: Vector
    frame: Frame = "world"
    type: Literal["force"] = "force"


class Couple(NamedTuple):
    """A couple on a body [N m]; `on` is its point of application, if the spec names one."""

    body: str
    on: End | None
    vector: Vector
    frame: Frame = "world"
    type: Literal["couple"] = "couple"


class Torque(NamedTuple):
    """A torque about a pin's axis [N m] or a thrust along a slide [N], on `to`, opposite on `from`.

    type: the kind of load that its value comes from, as a motor, whose torque is a function of the joint's rate
    """

    joint: str
    value: Expression
    type: str = "torque"


class Actuator(NamedTuple):
    """A force along the line between two points [N]; positive pushes them apart.

    type: the kind of load that its value comes from
    """

    from_: End
    to: End
    value: Expression
    type: str = "actuator"


class Spring(NamedTuple):
    """A spring and damper between two points: stiffness [N/m], free length [m], damping [N s/m].

    force: a law [N] instead of the stiffness; positive pushes the points apart
    """

    from_: End
    to: End
    stiffness: float
    length: float
    damping: float = 0.0
    force: Expression | None = None
    type: Literal["spring"] = "spring"


class TurnSpring(NamedTuple):
    """A spring and damper about a joint's axis: stiffness [N m/rad], free angle [rad], damping [N m s].

    torque: a law [N m] instead of the stiffness
    """

    joint: str
    stiffness: float
    angle: float
    damping: float = 0.0
    torque: Expression | None = None
    type: Literal["turn_spring"] = "turn_spring"


class Distributed(NamedTuple):
    """A line load on a body [N/m]: `vector` at from_, `to_vector` at to, linear between them."""

    body: str
    from_: Vec
    to: Vec
    vector: Vector
    to_vector: Vector
    frame: Frame = "world"
    type: Literal["distributed"] = "distributed"


@record
class Elastic(Generic[V, M]):
    """The springs and dampers of a bushing, for its translation or for its rotation, in its axes.

    stiffness: symmetric [N/m] or [N m/rad], 0 where a table replaces it
    damping: [N s/m] or [N m s]
    preload: [N] or [N m]
    extra_load: load besides the stiffness: the preload, plus a table over the deflection (with its areas)
    """

    stiffness: M
    damping: M
    preload: V
    extra_load: Vector


class Bushing(NamedTuple):
    """Six springs and dampers between two bodies, in axes fixed in the body of from_.

    to_rotation: the orientation of these axes in the body of `to`
    coupling, coupling_damping: force by rotation [N/rad], by its rate [N s]; the transpose is moment by displacement
    """

    from_: End
    to: End
    shift: Elastic[Vec, Matrix]
    turn: Elastic[Vec, Matrix]
    rotation: Matrix
    to_rotation: Matrix
    coupling: Matrix = ZERO_MATRIX
    coupling_damping: Matrix = ZERO_MATRIX
    type: Literal["bushing"] = "bushing"


class Damper(NamedTuple):
    """A damper in a joint: coefficient in N m s (turning) or N s/m (slide, line, plane), sliding in N s/m (cylinder).

    law: torque [N m] or force [N] on `to` as a function of the joint's rate, instead of the coefficients
    """

    joint: str
    coefficient: float
    sliding: float | None = None
    law: Expression | None = None
    type: Literal["damper"] = "damper"


class Friction(NamedTuple):
    """Coulomb friction in a joint: torque [N m] or force [N], in time, as it is, or times tanh(rate/speed).

    speed: None: as it is, so that it sticks
    coefficient: of friction by the joint's own reaction, instead; in a pin at a radius [m]
    static: of what sticks: a torque, a force or a coefficient like the kinetic one; None: the same
    length: of a guide that carries tilting moments at its two ends [m]
    """

    joint: str
    torque: Expression | None
    force: Expression | None
    speed: float | None
    coefficient: float | None = None
    static: float | None = None
    radius: float | None = None
    length: float | None = None
    type: Literal["friction"] = "friction"
