"""SciPy's stiff and switching integrators as independent checks (motion/integration/run/scipy_loop.py); their orders
vary.

They see loads only at their stages and may miss a pulse between two of them; so may a finer run of the same method.
Therefore the check run is the kernel's, which bounds the loads within a step.
"""

from __future__ import annotations

from heuncli.motion.integration.methods.collocation import RADAU9
from heuncli.motion.integration.methods.method import Method


def scipy_method(name: str, order: int) -> Method:
    """Make a method from a class of `scipy.integrate`."""
    return Method(
        name=f"SciPy-{name}", order=order, nodes=(), stages=(), solution=(), error_order=order, scipy_name=name,
        check=RADAU9,
    )  # fmt: skip


RADAU = scipy_method("Radau", 5)  # Radau IIA of three stages: Hairer, Wanner, Solving ODEs II, IV.8
BDF = scipy_method("BDF", 5)  # orders 1 to 5: Shampine, Reichelt, SIAM J. Sci. Comput. 18 (1997) 1-22
LSODA = scipy_method("LSODA", 12)  # Adams to 12, BDF to 5: Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136-148
