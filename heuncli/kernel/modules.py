"""The names of the kernel's compiled modules, as pyproject.toml has them."""

MODULES = (
    "memory",
    "expressions",
    "intervals",
    "enclosure",
    "tree",
    "loads",
    "closures",
    "orthogonal",
    "selection",
    "chosen",
    "response",
    "workspace",
    "dense",
    "events",
    "landing",
    "steps",
    "integration",
)
