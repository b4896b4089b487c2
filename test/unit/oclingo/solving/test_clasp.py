"""What clasp itself gets wrong, and is kept from."""

from pathlib import Path

import clingo

from rosoclingo.oclingo import ReactiveProgram

#: Part of what the mailbot's program became once (in aspif): clasp's equivalence preprocessing loses all its answers.
EQUIVALENCES = Path(__file__).parents[3] / "data" / "equivalences.aspif"


def add_rules(backend, lines):
    """Add the rules of a program in aspif; bodies are conjunctions or have weights."""
    atoms = {}

    def literal(number):
        """The literal of this control for that of the file."""
        atom = atoms[abs(number)] if abs(number) in atoms else atoms.setdefault(abs(number), backend.add_atom())
        return atom if number > 0 else -atom

    for line in lines:
        _, choice, size, *rest = map(int, line.split())
        head, (weighted, *body) = [literal(one) for one in rest[:size]], rest[size:]
        if weighted:
            pairs = [(literal(one), weight) for one, weight in zip(body[2::2], body[3::2])]
            backend.add_weight_rule(head, body[0], pairs, bool(choice))
        else:
            backend.add_rule(head, [literal(one) for one in body[1:]], bool(choice))


def test_no_answer_is_lost_by_preprocessing():
    control = clingo.Control(ReactiveProgram.from_text("#program base.").arguments())
    with control.backend() as backend:
        add_rules(backend, EQUIVALENCES.read_text(encoding="ascii").splitlines()[1:-1])
    assert control.solve().satisfiable
