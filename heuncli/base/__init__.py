"""Values, errors, text, kinds and thresholds: what every other package uses, and what uses none of them.

Neighbours use: `errors` (Problem, HeunError and its kinds), `tolerances` (every threshold), `joint_kinds.TYPES` and
`method_rows.METHODS` (a row a joint kind, a row a method), `records.record` and `named_tuples.NamedTuple` (records),
`linear_algebra` (null spaces, least squares), `files.write` (a file is written whole or not at all),
`text_safety.escape` (text from outside), `spelling` (typos).
"""
