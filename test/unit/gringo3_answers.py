"""Answers of gringo 3 programs, which clingo computes on their translations."""

import clingo

from rosoclingo.oclingo.gringo3 import Dialect, translate


def translated(text):
    """Return the translation of a program, with ambiguous statements read as gringo 3."""
    return translate(text, "test.lp", Dialect.GRINGO3).text


def solve(text):
    """Return all answers of a clingo 5 program as sorted strings of their shown atoms."""
    control = clingo.Control(["0"], logger=lambda code, message: None)
    control.add("base", [], text)
    control.ground([("base", [])])
    found = []
    control.solve(on_model=lambda model: found.append(" ".join(sorted({str(s) for s in model.symbols(shown=True)}))))
    return sorted(found)


def optima(text):
    """Return the optimal answers of a clingo 5 program."""
    control = clingo.Control(["0", "--opt-mode=optN"], logger=lambda code, message: None)
    control.add("base", [], text)
    control.ground([("base", [])])
    found = set()

    def note(model):
        if model.optimality_proven:
            found.add(" ".join(sorted(str(s) for s in model.symbols(shown=True))))

    control.solve(on_model=note)
    return sorted(found)


def answers(text):
    """Return all answers of a gringo 3 program."""
    return solve(translated(text))
