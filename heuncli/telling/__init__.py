"""What commands tell of a study in other forms than a report: its numbers as they are kept, and what changed of them.

kept.py       the numbers of a run as a golden file holds them, their form as text, and what is wrong with a file
keep.py       a study's numbers; sampled.py: those of a result in JSON
changes.py    what of two runs differs by more than both state; change_table.py: that as a table
"""
