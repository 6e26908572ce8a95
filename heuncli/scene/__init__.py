"""From text to a checked scene in SI units.

Neighbours use: `file_format.load.load` (YAML to `Spec`, or a SpecError with all problems and their places),
`file_format.models` (what a Spec holds), `expressions` (units, formulas, tables), `shapes` and `meshes` (mass, inertia,
cross-sections), `importers` (URDF and MJCF to a spec).
"""
