"""SciPy's stiff and switching integrators, as independent checks (integration/foreign.py); their orders vary."""

from __future__ import annotations

from heuncli.integration.methods.method import Method


def scipys(name: str, order: int) -> Method:
    """A method of `scipy.integrate`, by its class."""
    return Method(
        name=f"SciPy-{name}", order=order, nodes=(), stages=(), solution=(), error_order=order, foreign=name
    )


RADAU = scipys("Radau", 5)  # Radau IIA of three stages: Hairer, Wanner, Solving ODEs II, IV.8
BDF = scipys("BDF", 5)  # orders 1 to 5: Shampine, Reichelt, SIAM J. Sci. Comput. 18 (1997) 1-22
LSODA = scipys("LSODA", 12)  # Adams to 12, BDF to 5: Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136-148
