"""Write the moving bodies of a solved scene as glTF, for 3D programs, up to the horizon."""

from __future__ import annotations

import math

from heuncli.base import tolerances
from heuncli.output.figures.courses import choose_instants
from heuncli.output.machine_geometry.gltf import encode_gltf
from heuncli.output.machine_geometry.poses import compute_poses, find_up_direction
from heuncli.output.web_page.geometry import make_page_machine
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import find_largest_turns

WARNING = "--glb: a body rotates up to {:.0f}° between two instants; the animation between them is not accurate"


def make_glb(study: Study) -> bytes:
    """Make the glTF file of a solved motion; adds a warning to the study if its instants are too far apart."""
    times = choose_instants(study)
    if not study.has_one_instant and len(times) > 1:
        turned = float(find_largest_turns(study.setup, study.history, times).max(initial=0.0))
        if turned > tolerances.MAX_INTERPOLATED_TURN:
            study.later_warnings[WARNING.format(math.degrees(turned))] = None
    poses = compute_poses(study, times)
    return encode_gltf(make_page_machine(study.spec, study.setup.scene), poses, find_up_direction(study.spec, poses))
