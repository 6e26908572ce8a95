"""What Hypothesis draws is the same whatever else this process has loaded."""

from __future__ import annotations

from contextlib import suppress

from hypothesis import HealthCheck, settings

with suppress(ImportError):  # older versions have no such module
    from hypothesis.internal.conjecture import providers

    # Newer ones draw from the constants in all modules that are loaded, too. To find these they read every file of the
    # package and of the tests, which takes six seconds.
    if hasattr(providers, "_get_local_constants") and hasattr(providers, "_local_constants"):
        providers._get_local_constants = lambda: providers._local_constants

# How long it takes to draw is judged by the clock, which goes on while other programs run.
settings.register_profile("heun", suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("heun")
