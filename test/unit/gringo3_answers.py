"""What the tests of the translator share: answers of a gringo 3 program, computed by clingo on its translation."""

import clingo

from rosoclingo.oclingo.gringo3 import Dialect, translate


def translated(text):
    """The translation of a program that is gringo 3's where both languages read it differently."""
    return translate(text, "test.lp", Dialect.GRINGO3).text


def solve(text):
    """All answers of a clingo 5 program as a set of strings, each with the shown atoms in order."""
    control = clingo.Control(["0"], logger=lambda code, message: None)
    control.add("base", [], text)
    control.ground([("base", [])])
    found = []
    control.solve(on_model=lambda model: found.append(" ".join(sorted({str(s) for s in model.symbols(shown=True)}))))
    return sorted(found)


def optima(text):
    """The optimal answers of a clingo 5 program."""
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
    """All answers of a gringo 3 program."""
    return solve(translated(text))
