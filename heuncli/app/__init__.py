"""What users touch: the command line and the interface to Python.

`cli` has what all commands share (`registry`: a row a command; `entry`: words to an exit code), `commands` a folder
a command, `api` the way from a file to a solved scene, `python` the classes that `import heuncli` gives.
"""
