"""Results of a run: the JSON of the contract, with arrays in place of lists.

Arrays are float64 and run over the instants first: (n_t,), (n_t, 3), (n_t, 3, 3); runs of cuts (n_t, n_cuts).
`nan` in an array means that the laws of rigid bodies leave the component open (`null` in JSON). A block that does not
apply, or was not asked for, is absent (an empty dict or None). Knows nothing of where numbers come from.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Block = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Results:
    """Everything a run reports; field names and the nesting below them are those of the contract's section 3.

    bodies:     name -> position, velocity, center, center_velocity, center_acceleration, angular_velocity,
                angular_acceleration (n_t, 3); rotation (n_t, 3, 3)
    points:     "body.point" -> position, velocity, acceleration (n_t, 3)
    coordinates: joint -> angle, rate, acceleration | travel, speed, acceleration, angular_acceleration (n_t,)
    foundation: about (3,), force, moment (n_t, 3), axis {point, direction, pitch}, mass_effect {force, moment_orbital,
                moment_spin}, supports {joint: {force, moment}}, elements {force name: {force, moment, point}}
    joints:     name -> point, force, moment (n_t, 3), open [str], drive, axial, radial, tilting, tension (n_t,)
    sections:   name -> see the contract
    forces:     name -> value, length, rate, power (n_t,)
    energy:     kinetic, potential, work (n_t,)
    system_vector: total (n_t, 3), bodies {name: (n_t, 3)}
    """

    title: str
    spec: Block
    version: str
    model: Block
    status: Block
    time: Array
    bodies: Block = field(default_factory=dict)
    points: Block = field(default_factory=dict)
    coordinates: Block = field(default_factory=dict)
    foundation: Block = field(default_factory=dict)
    joints: Block = field(default_factory=dict)
    sections: Block = field(default_factory=dict)
    forces: Block = field(default_factory=dict)
    energy: Block = field(default_factory=dict)
    system_vector: Block = field(default_factory=dict)
    impulses: list[Block] = field(default_factory=list)
    certain_sums: list[Block] = field(default_factory=list)
    accuracy: Block = field(default_factory=dict)
    work: Block = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
