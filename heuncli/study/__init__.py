"""One scene solved, searched between its samples, each number with its error.

Neighbours use: `workflow.solve` (a Spec to a Study), `model.options.Options` (what and how), `queries` (measures,
expectations, instants of a solved scene), `search` (extremes and crossings), `quantities` (labels, units, digits),
`rainflow` and `load_collectives` (counts of load cycles).
"""
