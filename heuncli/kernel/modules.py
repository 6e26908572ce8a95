"""The names of the kernel's modules: what is compiled, what is imported through choose.py, what the tests expect."""

MODULES = (
    "memory",
    "expressions",
    "tree",
    "loads",
    "closures",
    "selection",
    "response",
    "workspace",
    "steps",
    "integration",
)
