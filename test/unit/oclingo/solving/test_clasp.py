"""What clasp itself gets wrong, and is kept from."""

from pathlib import Path

import clingo
import pytest

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update

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


@pytest.mark.parametrize(
    "text",
    [
        "#program base. { a; b }. :- 2 { a; b }.",
        "#program cumulative(t). 1 { a(t); b(t) } 1.",
        "#program volatile(t). { a(t); b(t) }. :- #count { 1 : a(t); 2 : b(t) } > 1.",
    ],
)
def test_no_answer_is_lost_by_preprocessing(text):
    control = clingo.Control(ReactiveProgram.from_text(text).arguments())
    with control.backend() as backend:
        add_rules(backend, EQUIVALENCES.read_text(encoding="ascii").splitlines()[1:-1])
    assert control.solve().satisfiable


def test_what_is_equivalent_takes_one_variable_where_nothing_has_weights():
    text = "#program base. {{ a }}. room(1..300). at(X) :- a, room(X). {}"
    variables = []
    for more in ("", "{ b; c }. :- 2 { b; c }."):
        control = clingo.Control(ReactiveProgram.from_text(text.format(more)).arguments())
        control.add("base", [], text.format(more))
        control.ground([("base", [])])
        control.solve()
        variables.append(control.statistics["problem"]["generator"]["vars"])
    without, with_weights = variables
    assert without < 10
    assert with_weights > 300


#: A walk with returns, a window, minimization and choices without bounds.
WALK = """
#program base. at(0,0).
#external _request/2. #external _return/3.
#program cumulative(t).
{ _action_lib(go,X+1,t); _action_lib(go,X-1,t) } :- at(X,t-1), wanted(Y,t-1).
:- _action_lib(go,X,t), _action_lib(go,Y,t), X < Y.
moved(t) :- _return(go,X,t).
at(X,t) :- _action_lib(go,X,t), _return(go,X,t).
at(X,t) :- at(X,t-1), not moved(t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t-1), not _action_lib(go,X,t).
#show _action_lib/3.
"""
UPDATES = (
    "#step 1 : 5. _request(2,1). #assert : a. :- at(9,3). #endstep.",
    "#step 2 : 5. :- not _action_lib(go,1,2). _return(go,1,2). #volatile : 3. :- at(8,4). #endstep.",
    "#step 3 : 9. #retract : a. #forget 1. #closed 1..2. :- not _action_lib(go,1,2). _request(3,3). #endstep.",
    "#step 4 : 9. #withdraw _return(go,1,2). #over 2. #endstep.",
)


@pytest.mark.parametrize(
    "options", [{}, {"shortest": True}, {"shortest": True, "plan_time": 0.1, "oclingo_strings": False}], ids=str
)
def test_neither_updates_nor_the_solver_add_rules_with_weights(monkeypatch, options):
    """To a program without; there clasp looks for what is equivalent."""
    rules, weighted = [], []

    class Rules(clingo.Observer):
        """Hears of all rules."""

        def rule(self, choice, head, body):
            """Record one."""
            rules.append(head)

        def weight_rule(self, choice, head, lower_bound, body):
            """Record one with weights."""
            weighted.append(head)

    class Watched(clingo.Control):
        """A control whose rules are heard of."""

        def __init__(self, *arguments, **more):
            super().__init__(*arguments, **more)
            self.register_observer(Rules())

    monkeypatch.setattr(clingo, "Control", Watched)
    program = ReactiveProgram.from_text(WALK)
    assert not program.weighs
    solver = ReactiveSolver(program, **options)
    for text in UPDATES:
        solver.update(parse_update(text))
        solver.improve()
    assert len(rules) > 50
    assert weighted == []
