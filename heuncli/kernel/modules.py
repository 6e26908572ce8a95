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
    "columns",
    "workspace",
    "dense",
    "course",
    "events",
    "contacts",
    "landing",
    "steps",
    "integration",
)
