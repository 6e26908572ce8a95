"""The compiled core: expressions, the sweep over the tree, closures, steps, events, derivatives; plain Python files.

Neighbours import `choose` and nothing else of it: the compiled module where there is one, else the same files as
they are. `form` says which of the two runs. The page on developing describes how it is built.
"""
