"""What users touch: the command line and the interface to Python.

`cli` has what all commands share (its own lines tell how a command line is run), `commands` a module or folder
a command, `reports` and `films` what other programs print and draw, `api` the way from a file to a solved scene,
`python` the classes that `import heuncli` gives.
"""
