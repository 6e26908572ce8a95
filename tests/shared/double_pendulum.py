"""The uniform double pendulum of manual/theory.md, "Chaos": its angles, found in 40 digits, as printed there."""

from __future__ import annotations

# Absolute angles from downward vertical
REFERENCE = {
    1: (-0.29182056951591, -1.20554568598800), 2: (-2.78689971182110, -1.73651330809759),
    5: (-0.439854790363542, 20.2604594237614), 10: (7.32792296542072, 25.6852343346577),
}  # fmt: skip
