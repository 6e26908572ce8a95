"""Arrays between the stages of a solution: their schema, the paths that name them, and their storage.

Neighbours use: `results.Results` (blocks of arrays of one solved scene), `results_schema.ROWS` (a row a quantity: path,
unit, shape, meaning), `results_paths` (from a path to numbers), `path_hints` (what a wrong path may have meant),
`stored_arrays` (long runs in a file).
"""
