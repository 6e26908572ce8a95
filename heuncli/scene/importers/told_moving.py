"""How an imported machine is moved, told at the head of its spec in the same words whatever the format."""

from __future__ import annotations


def told_moving(parameter: str, another: str, *, free: bool, at_rest: bool) -> tuple[str, ...]:
    """Lines of comment. parameter: of the first joint; another: a value for it; at_rest: so free joints start."""
    pose = f'--set {parameter}="{another}"'
    if free:
        start = "start at rest" if at_rest else "start"
        return (f"The joints are free, and {start} where their parameters say ({pose}).",)
    return (
        f"Drives hold the joints where their parameters say ({pose}); what they take is told as drive.",
        "A motion is a law of time in place of the parameter: 0.5*sin(2*t).",
    )
