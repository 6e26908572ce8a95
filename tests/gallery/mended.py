"""Which faults are gone from which kinds of pictures: what stands here is tested, and may not come back.

Who mends a fault (`python -m tests.gallery OUT`, then OUT/findings.txt) adds the kind of picture to its row; then
tests/pictures/test_gallery.py (for page and report: tests/browser/test_gallery.py) holds it. MENDED is complete when
every row has all kinds.
"""

from __future__ import annotations

PLOTS = ("scene", "history", "sections", "polar", "modes", "balance", "sweep", "chart")
MENDED: dict[str, tuple[str, ...]] = {
    "overlap": (*PLOTS, "page", "report"),  # words over words
    "band": PLOTS,  # words on the thin line of a band
    "long": PLOTS,  # six digits before the point
    "small": PLOTS,  # letters below 2.5 mm on paper
    "struck": PLOTS,  # a stroke through words
    "outside": (*PLOTS, "page", "report"),  # words beyond the picture or the window
    "empty": PLOTS,  # a third of the picture without ink
    "path": (*PLOTS, "page", "report"),  # joints.main.force in place of a name
    "noise": (*PLOTS[:-1], "page", "report"),  # 3e-15, 0.000219 kN
    "digits": (*PLOTS, "page", "report"),  # more than five significant ones
    "folder": (*PLOTS, "page", "report"),  # a folder of the machine that drew it
    "narrow": ("report",),  # a long table on less than half of the sheet
    "number": ("history",),  # a marked number that is no extreme of the run
}
SLOW = ("crane_ropes", "suspension")  # specs that take more than two seconds, left out of the tests of pictures
