"""A spec solved, and what is asked of it. Each room imports those below it alone:

workflow   the program of a run, as a list of its stages
ask        a solved scene (`Study`): measures, expectations, events
search     between its samples: extremes, crossings of zero
compose    answers at some instants as blocks of `Results`
solve      what happens, and how well it is known: `History`
model      what is solved, by which method, and why: `Setup`
"""
