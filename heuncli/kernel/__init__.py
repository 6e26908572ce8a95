"""The compiled core: expressions, the sweep over the tree, closures, steps, events, derivatives; plain Python files.

Other packages import `choose` and nothing else from it: the compiled module if there is one, else the same files as
they are. `form` chooses which of the two runs. The manual page on developing describes how it is built.
"""
