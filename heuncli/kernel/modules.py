"""The names of the kernel's compiled modules, as pyproject.toml has them."""

MODULES = (
    "memory",
    "expressions",
    "tree",
    "loads",
    "closures",
    "orthogonal",
    "selection",
    "chosen",
    "response",
    "workspace",
    "steps",
    "integration",
)
