"""SciPy's stiff and switching integrators, as independent checks (motion/integration/run/scipy_loop.py); their orders
vary.

They see of loads what their stages see, and pass over a pulse between two of them; a finer run of the same may, too. So
the check run is the kernel's, which bounds what loads do within a step.
"""

from __future__ import annotations

from heuncli.motion.integration.methods.collocation import RADAU9
from heuncli.motion.integration.methods.method import Method


def scipys(name: str, order: int) -> Method:
    """A method of `scipy.integrate`, by its class."""
    return Method(
        name=f"SciPy-{name}", order=order, nodes=(), stages=(), solution=(), error_order=order, foreign=name,
        check=RADAU9,
    )  # fmt: skip


RADAU = scipys("Radau", 5)  # Radau IIA of three stages: Hairer, Wanner, Solving ODEs II, IV.8
BDF = scipys("BDF", 5)  # orders 1 to 5: Shampine, Reichelt, SIAM J. Sci. Comput. 18 (1997) 1-22
LSODA = scipys("LSODA", 12)  # Adams to 12, BDF to 5: Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136-148
