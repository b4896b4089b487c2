"""Seeded faults: the lint finds each of them in its place, with its kind and hint.

The faults are seeded in the shipped programs, the tutorial's and oClingo's own ones.
"""

import lint_programs
import pytest
from workloads import sized

from rosoclingo.checking.lint.kinds import KINDS
from rosoclingo.oclingo.program.sources import Source

RULES = "delivery/rules.lp"

#: Program, file, old text, new text (@ marks the place of the finding), kind, words of the finding.
SEEDS = [
    # names that look misspelt, in bodies, in heads, in #show and #external
    ("house", "house.lp", "#external _seen/3.", "@#external _sen/3.", "misspelt", "did you mean _seen/3?"),
    ("lift", "lift.lp", "open(F,t) :- call(F,t).", "open(F,t) :- @cal(F,t).", "undefined", "did you mean call/2?"),
    ("grow", "grow.lp", "w(t) :- w(t-1).", "w(t) :- @v(t-1).", "undefined", "write a rule or an #external for it"),
    # unused predicates
    ("garden", "garden.lp", "poured(t)    :- w", "@thirst(t) :- busy(t).\npoured(t) :- w", "unused", "remove it"),
    # impossible values
    ("garden", "garden.lp", "at(tap,t-1)", "at(@tab,t-1)", "no-match", "did you mean tap?"),
    # circular rules, and bodies that never hold
    ("bound", "bound.lp", "c(t) :- e(t).", "@c(t) :- d(t).\nd(t) :- c(t).", "unfounded", "its rules need d/1"),
    ("lift", "lift.lp", "up(t), F < 5.", "up(t), F < 5, @not up(t).", "contradiction", "up(t) and not up(t)"),
    ("garden", "garden.lp", "V != P.\nfailed(t)", "@V != V.\nfailed(t)", "contradiction", "V != V never holds"),
    # steps
    ("garden", "garden.lp", "asked(t)      :-", "@asked        :-", "no-step", "as in asked(t)"),
    (
        "lift",
        "lift.lp",
        "open(F,t) :- call(F,t).",
        "open(F,t) :- call(F,t).\n@called(F) :- call(F,t).",
        "redefinition",
        "called(0)",
    ),
    (
        "paper",
        "paper.lp",
        "at(L,t)         :- at(L,t-1)",
        "@at(L,t+1)       :- at(L,t)",
        "no-step",
        "have the steps t and t+1",
    ),
    ("bound", "bound.lp", "c(t) :- e(t).", "c(t) :- @e(t+1).", "late-external", "write #external e(t+1)."),
    ("back", "back.lp", "#volatile t.", "", "missing-part", "the program has no volatile part"),
    ("garden", "garden.lp", "at(L,t)      :- at(L,t-1)", "@at(L,t)      :- at(L,t)", "tautology", "another step"),
    ("paper", "paper.lp", "_return(A,V,t), V != P", "_return(A,V,t), @V = P", "same-variables", "or V != P"),
    ("garden", "garden.lp", "thirsty(P,t-1), not wat", "@thirsty(P,t+1), not wat", "look-ahead", "thirsty(P,t+1)"),
    ("paper", "paper.lp", "at(L,t)         :- done", "@at(t,L)         :- done", "exchanged", "as argument 2"),
    ("garden", "garden.lp", "at(home,0).", "@at(home,1).", "first-step", "whose own rules define it"),
    ("garden", "garden.lp", "at(home,0).", "at(home,0).\nbegun :- @busy(t).", "look-ahead", "never true"),
    (
        "garden",
        "garden.lp",
        ":- thirsty(P,t), not watered(P,t).",
        "dry(P,t) :- thirsty(P,t), not watered(P,t).\n:- dry(P,t), @dry(P,t-1).",
        "past-volatile",
        "move the rules of dry/2 to #program cumulative(t).",
    ),
    # looks back
    ("paper", "paper.lp", "done(pickup,Id,t).", "@_action_lib(pickup,Id,_), busy(t).", "history", "t-T < 60"),
    ("battery", "battery.lp", "_battery(low,t).", "@_battery(low,T), T <= t.", "history", "like t-T < 60"),
    # exchanged names and arguments
    ("template", "@NAME@.lp", "at(P,t)       :- moved", "at(@p,t)       :- moved", "lower-case", "did you mean P?"),
    # punctuation that changes the statement
    ("garden", "garden.lp", "place(home). place(tap).", "place(home). place(tap)@,", "mark", "did you mean a dot?"),
    ("lift", "lift.lp", "open(F,t) :- call(F,t).", "open(F,t) @: call(F,t).", "mark", "did you mean ':-'?"),
    ("battery", "battery.lp", "t) : asked(W,I,t), W", "t); @asked(W,I,t), W", "syntax", "unexpected"),
    ("paper", "paper.lp", "cancel(Id),t).\nwaiting", "cancel(Id),t)@,\nwaiting", "syntax", "a comma stands where a"),
    # constants and variables that occur once
    ("garden", "garden.lp", "place(home).", "place(@hoem).", "misspelt", "did you mean home?"),
    ("paper", "paper.lp", "_request(cancel(Id),t).\nc", "_request(@cancel(me,Id),t).\nc", "misspelt", "cancel(Id)"),
    # swapped arguments, mismatched steps
    ("paper", "paper.lp", "_request(cancel(Id),t).\nc", "@_request(t,cancel(Id)).\nc", "exchanged", "as argument 2"),
    ("paper", "paper.lp", "_return(A,V,t), V", "@_return(A,V,t-1), V", "other-step", "the same cycle"),
    ("paper", "paper.lp", "_action_lib(move_base,B,t)", "@_action_lib(move_base,B,t-1)", "other-step", "write t for"),
    ("garden", "garden.lp", "#program cumulative(t).\n\n% Failures", "% Failures", "at-the-end", "before the"),
    # atoms exchanged with the core
    ("garden", "garden.lp", "#show _action_lib/3.\n", "", "hidden", "write #show _action_lib/3."),
    ("template", "@NAME@.lp", "_says(move_base,", "_says(@movebase,", "idle-words", "did you mean move_base?"),
    ("template", "@NAME@.lp", '_says("visit(', '_says(@"visits(', "idle-words", "rules ask for visit(P)"),
    ("template", "@NAME@.lp", '"Visit the {Place}"', '@"Visit the {Room}"', "idle-words", "has no variable Room"),
    ("template", "@NAME@.lp", '_says("_closed(P', '_says(@"_closes(P', "idle-words", "no external fact"),
    (
        "paper",
        "paper.lp",
        "cancelled(Id,t)       :- _request(cancel(Id),t)",
        "cancelled(Id,t) :- @_request(cancel(Id))",
        "keyword-arity",
        "_request(Goal,C)",
    ),
    ("two_arms", "two_arms.lp", "#external _request/2.", "", "no-request", "write #external _request/2."),
    ("paper", "paper.lp", "#external _return/3.", "", "no-return", "write #external _return/3."),
    (
        "two_arms",
        "two_arms.lp",
        "_action_lib(A,P,t) :- todo",
        "act(A,P,t) :- todo",
        "no-action",
        "_action_lib(Action,Parameter,C)",
    ),
    (
        "garden",
        "garden.lp",
        "_status(P,canceled,t)      :-",
        "_status(P,@cancelled,t)      :-",
        "status-word",
        "did you mean canceled?",
    ),
    ("garden", "garden.lp", "_status(P,succeeded,t)     :-", "_status(P,accepted,t)     :-", "no-success", ""),
    (
        "garden",
        "garden.lp",
        "_status(P,succeeded,t)     :- w",
        "_status(P,@succeeded,t)     :- at(oak,t), w",
        "unreachable-status",
        "nothing satisfies its body",
    ),
    (
        "two_arms",
        "two_arms.lp",
        "_action_lib(A,P,t) :-",
        "1 { @_action_lib(go,(a;b),t) }.\n_action_lib(A,P,t) :-",
        "restless",
        "each step has an action",
    ),
    # clingo's incmode, telingo, programs with their own driver
    (
        "grow",
        "grow.lp",
        "w(t) :- w(t-1).",
        "w(t) :- w(t-1).\n#external @query(t).\n:- query(t), not w(t).",
        "incmode",
        "query(t)",
    ),
    ("bound", "bound.lp", ":- not c(t).", ":- not c(t), @query(t).", "undefined", "clingo's incmode"),
    ("grow", "grow.lp", "w(t) :- w(t-1).", "w(t) :- w(t-1).\n@#const imax = 20.", "incmode", "~horizon_limit"),
    ("grow", "grow.lp", "w(t) :- w(t-1).", "w(t) :- @'w(t-1).", "undefined", "in telingo 'w is w 1 step before"),
    ("paper", "paper.lp", "#program base.", "@#program initial.", "unknown-part", "telingo's part"),
    ("paper", "paper.lp", "#program cumulative(t).", "@#program step(t).", "unknown-part", "#program cumulative(t)."),
    ("lift", "lift.lp", "at(0,0).", "at(0,0).\n@#include <incmode>.", "not-interpreted", "#include <incmode>"),
    ("lift", "lift.lp", "at(0,0).", "at(0,0).\nhigh(@@top(5)).", "not-interpreted", "no script defines @top"),
    ("lift", "lift.lp", "at(0,0).", "at(0,0).\n:- @&final.", "syntax", "no #theory defines the theory atom &final"),
    # constants, and messages of clingo
    ("lift", "lift.lp", "at(0,0).", "at(0,0).\nhigh :- F = 1, 0 < #sum { @F : at(F,X) }.", "clingo", "global variable"),
    ("mailbot", RULES, "_full(t) :- capacity {", "_full(t) :- @capcity {", "no-number", "did you mean capacity?"),
    ("mailbot", "office.lp", "start(office1)", "start(hall)", "no-match", "no L fits both start(L) and place(L)"),
    ("garden", "garden.lp", "can(0,0).", "can(0,0).\ntwice(P@+1) :- plant(P).", "undefined-operation", "(P+1)"),
    ("encoding_window", "encoding_window.lp", "foo(t).", "@foo(t,X) :- not s(X).", "unsafe", "unsafe variable X"),
    ("errands", "errands.lp", "check: ok history\n", "check: ok histry\n", "silence", "did you mean history?"),
]

#: Faults in small programs, where a kind has some.
ONE_OF_EACH_KIND = {
    seed[4]: seed for seed in sorted(SEEDS, key=lambda seed: seed[0] in ("mailbot", "house"), reverse=True)
}.values()


def seeded(name, file, old, new):
    """Return the sources of a program with the fault, and the line and column of the fault."""
    found, place = [], None
    for one in lint_programs.program(name):
        if one.name == file:
            text, place = lint_programs.seeded(one.text, old, new)
            one = Source(file, text)
        found.append(one)
    assert place is not None, f"{name} has no file {file}"
    return found, place


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "file", "old", "new", "kind", "words"), lint_programs.marked(sized(list(ONE_OF_EACH_KIND), SEEDS))
)
def test_lint_finds_a_seeded_fault(name, file, old, new, kind, words):
    sources, (line, column) = seeded(name, file, old, new)
    found = lint_programs.lint(sources)
    printed = "\n".join(map(str, found))
    mine = [one for one in found if one.fault.kind == kind and words in str(one)]
    assert mine, f"no finding of kind {kind} with {words}:\n{printed}"
    if "@" in new:
        places = {(one.fault.file, one.fault.line) for one in mine}
        assert (file, line) in places, f"not at {file}:{line}:{column}\n{printed}"


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_seeds_cover_each_kind(kind):
    elsewhere = {
        "translation", "unknown-constant", "constant-value", "negative-constant", "stream-syntax", "stream-fact",
        "no-interface", "idle-interface", "idle-reason", "no-label", "idle-label", "unheard-fact", "unheard-order",
        "configuration", "message-type", "label-value", "like-reason", "idle-drawing",
    }  # fmt: skip
    assert kind in elsewhere or any(seed[4] == kind for seed in SEEDS)
