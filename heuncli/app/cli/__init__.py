"""What all commands share. So `heun run x.yaml --format json | head` goes from words to bytes:

1. `heuncli/__main__.py` installs the signal handlers, lets `terminal` answer `--help` and `--version`, and calls
   `entry.enter` with the words.
2. `enter` runs the line, and turns every failure into problems on standard error and an exit code.
3. `entry` finds the row of `run` in `registry`, imports its request and fills it; help and errors of usage are
   left to `typer_reader`.
4. It starts the time limit (`timeout`) and calls `main` of the row's module with the request.
5. `commands/run/command.py` checks the options before any work: `target` format, units, and that no input
   is overwritten, `solving` the options of the solver.
6. It reads the spec and its load cases (`api.read`), puts in titles and labels (`solving`), and selects which
   results are computed.
7. `commands/run/scene.py` solves the scene (`study/workflow.py`).
8. For tables it makes an OutputDocument, which `documents` writes for the terminal, a file or a pipe; for JSON,
   `output/tables/export.py` makes the text piece by piece.
9. `output.emit` ends the time limit and writes the pieces, encoded, to the file or to descriptor 1.
10. When `head` has closed the pipe, the next write raises ReaderGoneError and `enter` returns 141; else `main` prints
    the warnings and returns 0.
"""
