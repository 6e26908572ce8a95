"""Folders of the checkout: its root, its kernel, and the worked examples that the README shows."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
SPECS = ROOT / "specs"
KERNEL = ROOT / "heuncli" / "kernel"
