"""A URDF as imported, and moved: its spec with the drives edited as a user edits them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from heuncli.scene.file_format.source import parse_source
from heuncli.scene.importers.description import DescribedBody, DescribedEntry, DescribedMachine
from heuncli.scene.importers.spec_text import format_spec
from tests.shared.imported import described
from tests.shared.pinocchio_answers import Asked, LinkMotion

COORDINATES = {"pin": ("angle", "rate"), "slide": ("travel", "speed")}


@dataclass(frozen=True, eq=False)
class ImportedRobot:
    """The described machine, its spec as text and as data; names in the spec by those in the file."""

    machine: DescribedMachine
    text: str
    spec: dict[str, Any]
    joints: Mapping[str, str]
    bodies: Mapping[str, str]

    @property
    def spec_of_tests(self) -> dict[str, Any]:
        """The spec as the tests write one: without its version."""
        return {key: value for key, value in self.spec.items() if key != "heun"}

    def moved(self, asked: Asked, links: Mapping[str, LinkMotion]) -> dict[str, Any]:
        """The spec in a state: laws q + v t + a t²/2 in its drives, start values where joints and bodies are free."""
        joints, drives, bodies = dict(self.spec["joints"]), dict(self.spec.get("drives", {})), self._placed(links)
        of = {entry["joint"]: name for name, entry in drives.items()}
        for old, name in self.joints.items():
            if old not in asked.q:
                continue
            key, rate = COORDINATES[joints[name]["type"]]
            if name in of:
                law = f"{asked.q[old]!r} + {asked.v[old]!r}*t + {asked.a[old]!r}*t**2/2"
                drives[of[name]] = {"joint": name, key: law}
            else:
                joints[name] = {**joints[name], "initial": {key: asked.q[old], rate: asked.v[old]}}
        return {**self.spec_of_tests, "joints": joints, "drives": drives, "bodies": bodies}

    def damping(self, old: str) -> float:
        """Of a joint, by its name in the file [N m s or N s/m]."""
        forces = self.spec.get("forces", {}).values()
        return float(sum(force["coefficient"] for force in forces if force["joint"] == self.joints[old]))

    def _placed(self, links: Mapping[str, LinkMotion]) -> dict[str, Any]:
        """The bodies; those whose start is given, with pose and rates."""
        bodies = dict(self.spec["bodies"])
        for old, name in self.bodies.items():
            body = bodies[name]
            if "position" in body or "near" in body:
                at = links[old]
                bodies[name] = {
                    **{key: value for key, value in body.items() if key != "near"},
                    "position": at.position.tolist(), "orientation": {"matrix": at.rotation.tolist()},
                    "velocity": at.velocity.tolist(), "angular_velocity": at.angular_velocity.tolist(),
                }  # fmt: skip
        return bodies


def imported_robot(text: str, **asked: Any) -> ImportedRobot:
    """A URDF as imported; asked: as ImportAsked takes it. Raises SpecError."""
    machine = described(text, **asked)
    written = format_spec(machine, "robot.yaml")
    joints = {called_before("joint", entry): entry.name for entry in machine.joints}
    bodies = {called_before("link", body): body.name for body in machine.bodies}
    return ImportedRobot(machine, written, parse_source("robot.yaml", written, "").data, joints, bodies)


def called_before(kind: str, entry: DescribedEntry | DescribedBody) -> str:
    """What the file calls an entry: its remark says so where the spec calls it otherwise."""
    head = f'{kind} "'
    if not entry.remark.startswith(head):
        return entry.name
    return entry.remark.removeprefix(head).rpartition('"')[0]
