"""The method for a motion that its drives determine: nothing is integrated (kernel/following.py).

Its interpolation has two rows more than the cubic's.
"""

from __future__ import annotations

from heuncli.motion.integration.methods.method import Method

DRIVE_DETERMINED = Method(
    name="none: each instant is solved separately",
    order=1,
    nodes=(0.0,),
    stages=(),
    solution=((0, 1.0),),
    extra=(),
    estimates=(((0, 1.0),),),
    error_order=1,
    dense=((), ()),
    is_determined=True,
)
