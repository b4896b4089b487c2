"""Relaxed programs: the kinds of rules that a search can disable."""

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.explaining.named_rules import RuleKind
from rosoclingo.planning.explaining.relaxed_program import RelaxedProgram

TEXT = """\
#program base.
p(1..2). q(a;b).  :- p(X), q(Y), X > 7.
#program cumulative(t).
{ go(X,t) : p(X) } 1.  { free(t) }.
#count { 1 : s(1,t); 2 : s(2,t) } 1 :- go(1,t).
not s(X,t) :- go(X,t).  fine(t) :- p("%").
#program volatile(t).
:- not go(1,t), p(_).
"""


def test_relaxed_program_classifies_every_kind_of_rule():
    relaxed = RelaxedProgram.of(ReactiveProgram.from_text(TEXT))
    assert [(one.kind, one.line, one.text) for one in relaxed.rules] == [
        (RuleKind.FACT, 2, "p(1..2)."),
        (RuleKind.FACT, 2, "q(a)."),
        (RuleKind.FACT, 2, "q(b)."),
        (RuleKind.INTEGRITY, 2, ":- p(X), q(Y), X > 7."),
        (RuleKind.BOUND, 4, "{ go(X,t) : p(X) } 1."),
        (RuleKind.BOUND, 5, "#count { 1 : s(1,t); 2 : s(2,t) } 1 :- go(1,t)."),
        (RuleKind.INTEGRITY, 6, "not s(X,t) :- go(X,t)."),
        (RuleKind.VOLATILE, 8, ":- not go(1,t), p(_)."),
    ]
    assert [one.variables for one in relaxed.constraints] == [("X", "Y"), (), (), ("X",), ()]
