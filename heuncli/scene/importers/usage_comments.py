"""Explain how to move an imported machine, in the comments at the head of its spec; the same words for all formats."""

from __future__ import annotations


def explain_motion(parameter: str, example_value: str, *, free: bool, at_rest: bool) -> tuple[str, ...]:
    """Return comment lines on how to move the joints.

    parameter: the parameter of the first joint
    example_value: a value for it
    at_rest: whether free joints start at rest
    """
    pose = f'--set {parameter}="{example_value}"'
    if free:
        start = "start at rest" if at_rest else "start"
        return (f"The joints are free, and {start} at the values of their parameters ({pose}).",)
    return (
        f"Drives hold the joints at the values of their parameters ({pose}); their loads are reported as drive.",
        "For a motion, replace the parameter in a drive by a function of time: 0.5*sin(2*t).",
    )
