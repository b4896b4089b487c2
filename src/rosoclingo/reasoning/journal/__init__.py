"""The journal: the state of a core is written down before anybody can see what follows from it, to go on from there.

All of it lies around :mod:`rosoclingo.reasoning.core`, which knows nothing of it.
"""
