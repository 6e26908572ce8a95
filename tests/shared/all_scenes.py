"""Every scene there is, by name, as text: the worked examples, the starters, and the scenes of tests/shared.

Of tests/shared all texts that are whole specs are found by looking; of functions that draw scenes there are two seeds,
one at an instant and one in motion.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import tests.shared
from heuncli.base.errors import HeunError
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.folders import ROOT, SPECS

STARTERS = ROOT / "heuncli" / "starters"
DRAWN = (  # functions of tests/shared that draw a scene by its seed
    "cam_scenes.cam_scene", "coupled_scenes.coupled_scene", "coupled_in_a_plane.coupled_flat",
    "doubles.redundant_scene", "geared_scenes.geared_scene", "loops.loop_scene", "planar_scenes.flat_scene",
    "reducible.carried", "reducible.driven",
    "reducible.welded", "reducible.round_scene", "rope_scenes.rope_scene", "rubbing.rubbing_scene",
    "rolling_scenes.rolling_scene", "stopped_trees.stopped_tree", "thin_rods.thin_rods", "train_scenes.train_scene",
    "trees.tree_scene",
)  # fmt: skip
SHORT = {"duration": 0.2, "samples": 5}
NO_SCENES = frozenset({"all_scenes", "chromium", "dask_cluster"})  # nothing to be looked through


def all_scenes() -> dict[str, str]:
    """The texts of all scenes by name, those of files first."""
    found = {path.stem: path.read_text(encoding="utf-8") for path in sorted(SPECS.glob("*.yaml"))}
    found |= {f"new-{path.stem}": path.read_text(encoding="utf-8") for path in sorted(STARTERS.glob("*.yaml"))}
    return found | dict(written_scenes()) | dict(drawn_scenes())


def written_scenes() -> Iterator[tuple[str, str]]:
    """The constants of tests/shared that are whole specs, each text once."""
    told: set[str] = set()
    for module in sorted(one.name for one in pkgutil.iter_modules(tests.shared.__path__)):
        if module in NO_SCENES:
            continue
        for name, value in vars(import_module(f"tests.shared.{module}")).items():
            members = value.items() if isinstance(value, dict) else [("", value)]
            for key, text in members:
                if isinstance(text, str) and text not in told and is_scene(text):
                    told.add(text)
                    yield f"{module}-{name}{f'-{key}' if key else ''}", text


def is_scene(text: str) -> bool:
    """Whether a text is a spec without errors."""
    if "heun: 1" not in text:
        return False
    try:
        load("scene.yaml", text)
    except HeunError:
        return False
    return True


def drawn_scenes() -> Iterator[tuple[str, str]]:
    """The scenes that functions draw: one at an instant, and one in motion."""
    for name in DRAWN:
        module, _, function = name.partition(".")
        draw = getattr(import_module(f"tests.shared.{module}"), function)
        for seed, analysis in ((1, None), (2, SHORT)):
            scene: Any = draw(seed)
            scene = scene[0] if isinstance(scene, tuple) else scene
            if isinstance(scene, str):
                yield f"{module}-{function}-{seed}", scene
                continue
            analysis = SHORT if "impulses" in scene else analysis
            yield f"{module}-{function}-{seed}", to_yaml(scene if analysis is None else {**scene, "analysis": analysis})


def link_files(folder: Path) -> None:
    """The files that scenes name (tables, meshes) into a folder."""
    for source in (SPECS, STARTERS):
        for path in source.iterdir():
            if path.is_file() and path.suffix not in (".yaml", ".py") and not (folder / path.name).exists():
                (folder / path.name).symlink_to(path)
