"""A conrod's bending in flight: its own inertia across it runs linearly from end to end, so that its moment is a cubic.

At the big end the crank pin's acceleration, at the small end the piston's; a0, aL are their parts along e1, mu the mass
a length. dQ1/ds = mu a, dM2/ds = -Q1, and M2 = 0 at both pins:

    M2(s) = mu (a0 s (L - s) / 2 + (aL - a0) s (L² - s²) / (6 L)),   Q1 = -dM2/ds
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.shared.drawn_bars import CONROD, panels_of
from tests.shared.drawn_panels import edges, heights
from tests.shared.scenes import study

R, L, W, MASS = 0.05, 0.2, 300.0, 0.6
S = np.linspace(0.0, L, 301)


@pytest.fixture(scope="module")
def flying() -> Study:
    return study(CONROD)


def across(phi: Array) -> tuple[Array, Array]:
    """The accelerations of the two pins along the rod's e1, at crank angles."""
    sine = R / L * np.sin(phi)  # of the rod's angle, below the line of the guide
    cosine = np.sqrt(1.0 - sine**2)
    rate = W * R * np.cos(phi) / (L * cosine)
    turning = (rate**2 * sine - R / L * W**2 * np.sin(phi)) / cosine
    piston = -R * W**2 * np.cos(phi) - L * (rate**2 * cosine + turning * sine)
    return -R * W**2 * (np.cos(phi) * sine + np.sin(phi) * cosine), piston * sine


def bending(phi: Array, s: Array) -> tuple[Array, Array]:
    """Q1 and M2 at crank angles (n, 1) and places (k,)."""
    a0, aL = across(phi)
    mu, rise = MASS / L, (aL - a0) / (6.0 * L)
    moment = mu * (a0 * s * (L - s) / 2.0 + rise * s * (L**2 - s**2))
    return -mu * (a0 * (L - 2.0 * s) / 2.0 + rise * (L**2 - 3.0 * s**2)), moment


@pytest.mark.parametrize("degrees", [10.0, 77.0, 90.0, 200.0, 315.0])
def test_the_moment_is_a_cubic_at_an_instant(flying: Study, degrees: float) -> None:
    """What is drawn at an instant between the samples, too, to half a pixel."""
    phi = np.radians(degrees)
    shown = panels_of(flying, "shank", [phi / W])
    for quantity, exact in zip(("Q1", "M2"), bending(phi, S), strict=True):
        panel = shown[quantity]
        assert np.abs(heights(panel.curve(quantity), S) - exact).max() <= 0.5 * panel.pixel
        marked = panel.marks[:, 1]
        for most in (exact.min(), exact.max()):
            if abs(most) > 5.0 * panel.pixel:
                assert np.abs(marked - most).min() <= panel.pixel


def test_the_band_is_the_least_and_the_greatest_of_all_crank_angles(flying: Study) -> None:
    """At each place, to a pixel; in it the curve of the instant at which it is largest, which its mark names."""
    phi = np.linspace(0.0, 2.0 * np.pi, 20001)[:, None]
    shown = panels_of(flying, "shank")
    for quantity, exact in zip(("Q1", "M2"), bending(phi, S), strict=True):
        panel = shown[quantity]
        low, high = edges(panel.areas[f"minimum and maximum of {quantity}"], S)
        assert np.abs(low - exact.min(axis=0)).max() <= panel.pixel
        assert np.abs(high - exact.max(axis=0)).max() <= panel.pixel
        at = int(np.abs(exact).max(axis=1).argmax())
        lines = [exact[at], exact[-1 - at]]  # half a turn the other way they are as large
        assert min(np.abs(heights(panel.curve(quantity), S) - line).max() for line in lines) <= panel.pixel
        told = [text for text in panel.texts() if "t = " in text]
        times = [float(text.partition("t = ")[2].removesuffix(" s")) for text in told]
        assert len(times) == 2
        assert min(abs(t - float(phi[at, 0]) / W) for t in times) <= 2e-5


def test_the_area_of_the_shear_is_the_moment(flying: Study) -> None:
    """M2(s) = -int Q1 ds of the drawn curve, everywhere along the rod."""
    shown = panels_of(flying, "shank", [np.pi / 2.0 / W])
    shear, moment = shown["Q1"], shown["M2"]
    s = np.linspace(0.0, L, 2001)
    q = heights(shear.curve("Q1"), s)
    area = np.concatenate([[0.0], np.cumsum(0.5 * (q[1:] + q[:-1]) * np.diff(s))])
    off = np.abs(heights(moment.curve("M2"), s) + area).max()
    assert off <= 0.5 * moment.pixel + 0.5 * shear.pixel * L
