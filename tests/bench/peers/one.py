"""One integration in a process of its own: `python -m tests.bench.peers.one PROGRAM,SCENE,WAY,SETTING`."""

from __future__ import annotations

import importlib
import sys

program, scene, number, setting = sys.argv[1].split(",")
way = importlib.import_module(f"tests.bench.peers.with_{program}").ways(scene)[int(number)]
integrate, centers = way.prepare(way.settings[int(setting)])
integrate()
print(centers())
