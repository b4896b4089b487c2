"""Which observations are taken otherwise or withheld, on a planner that only knows what can't be so together."""

import pytest
from clingo import parse_term

from rosoclingo.oclingo import SolveOutcome, SolverError, SolveResult, Statement, StreamUpdate, commitment
from rosoclingo.oclingo.progression.updates import Closed, Withdraw
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import Batch, Clock
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.mending import Case, Change, mend
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.recovery import Question
from rosoclingo.reasoning.stream_planner import Halt

#: The cycle that the update starts.
STEP = 5

SATISFIABLE, UNSATISFIABLE, INTERRUPTED = SolveOutcome.SATISFIABLE, SolveOutcome.UNSATISFIABLE, SolveOutcome.INTERRUPTED


class World:
    """A planner of an update with facts ``new``, after ``old`` ones and actions that were ``done``, all as text.

    None of ``conflicts``, of facts, actions and goals (g1, ...), can be; of ``slow`` it is not known whether it can.
    ``refused`` are taken by no solver, nor is anything after ``most`` searches. ``time`` is the number of searches
    after which time is over. The update's own facts are among the observations already, as with the core.
    """

    def __init__(self, new="", conflicts=(), **others):
        self.new, self.old = (
            [Observation(parse_term(one), 2) for one in text.split()] for text in (new, others.pop("old", ""))
        )
        self.done = [action_of(parse_term(f"_action_lib({one})")) for one in others.pop("done", "").split()]
        self.requests = [parse_term(f"_request({one})") for one in others.pop("requests", "").split()]
        self.goals = [
            Goal(f"g{one}", parse_term(f"go({one})"), lambda _goal, _event: None) for one in others.pop("goals", "")
        ]
        for one in self.goals:
            one.feed(3)
        self.conflicts = [set(one.split()) for one in conflicts]
        self.slow = [set(one.split()) for one in others.pop("slow", ())]
        self.refused = [set(one.split()) for one in others.pop("refused", ())]
        self.time, self.most = others.pop("time", None), others.pop("most", None)
        assert not others
        self.asked, self.updates, self.left = [], [], None

    def watch(self):
        self.left = self.time
        return lambda: Halt("time is over") if self.left is not None and self.left <= 0 else None

    @property
    def case(self):
        facts = [Statement(one.atom) for one in self.new]
        items = (
            Closed(4, 4),
            *map(commitment, [one.atom for one in self.done[-1:]]),
            *map(Statement, self.requests),
            *facts,
        )
        goals = tuple(reversed(self.goals))
        question = Question(STEP + 1, goals, tuple(reversed(self.old)), self.watch, 7)
        batch = Batch(StreamUpdate(STEP), facts=tuple(self.new))
        clock = Clock(lambda name, arity: {"_kind": None, "_next": 1}.get(name, 0))
        return Case(batch, StreamUpdate(STEP, 7, items), tuple(self.done), question, clock)

    def instead(self, update, undone=frozenset()):
        self.updates.append(update)
        assert update.step == STEP
        withdrawn = {item.atom for item in update.items if isinstance(item, Withdraw)}
        assert withdrawn <= {one.atom for one in self.old}
        told = {str(item.head) for item in update.items if isinstance(item, Statement) and item.head is not None}
        brought = {one.atom for one in self.new}
        told |= {str(one.atom) for one in self.old if one.atom not in withdrawn | brought}
        told |= {f"{one.interface}({one.parameter})" for one in self.done if one.atom not in undone}
        found = Beside(self, told, undone)
        return found, found.result({one.key for one in self.goals})

    def outcome(self, told):
        self.left = None if self.left is None else self.left - 1
        self.asked.append(" ".join(sorted(told)))
        if any(one <= told for one in self.refused) or len(self.asked) - 1 == self.most:
            raise SolverError("refused by the test")
        if any(one <= told for one in self.conflicts):
            return UNSATISFIABLE
        return INTERRUPTED if any(one <= told for one in self.slow) else SATISFIABLE


class Beside:
    """A planner beside that of the world."""

    def __init__(self, world, told, undone):
        self.world, self.told, self.undone, self.outcome = world, told, undone, None
        self.lookahead = 7

    def result(self, goals):
        self.outcome = self.world.outcome(self.told | goals)
        return SolveResult(self.outcome, (), STEP + 3, STEP)

    def restarted(self, without):
        return Beside(self.world, self.told, self.undone)

    def update(self, update):
        gone = {str(item.head.arguments[0].arguments[0]) for item in update.items if isinstance(item, Statement)}
        gone |= {str(item.atom.arguments[0].arguments[0]) for item in update.items if isinstance(item, Withdraw)}
        return self.result({one.key for one in self.world.goals if one.key[1:] not in gone})


def changes(world):
    """What becomes of the observations that are doubted: as which fact they are taken, and what they deny."""
    found = mend(world, world.case)
    assert found.planner.undone == frozenset(), "what was done was done"
    assert found.planner.outcome is found.result.outcome
    return [
        f"{one.observation.atom}{'' if one.sure else '?'} {one.taken_as or '-'}"
        + "".join(f" {action.interface}({action.parameter})" for action in one.against)
        for one in found.changes
    ]


@pytest.mark.parametrize(
    ("world", "changed"),
    [
        # what comes late is doubted before what is new, that before what is older, and how actions ended at last
        (World("_a(2) _a(5)", ["_a(2) _a(5)"]), ["_a(2) _a(5)"]),
        (World("_a(5) _a(2)", ["_a(2) _a(5)"]), ["_a(2) _a(5)"]),
        (World("_a(5) _b(2)", ["_a(5) _b(2)"]), ["_b(2) _b(5)"]),
        (World("_kind(2) _b(2)", ["_kind(2) _b(2)"]), ["_b(2) _b(5)"]),
        (World("_a(5)", ["_a(5) _b(5)"], old="_b(5)"), ["_a(5) -"]),
        (World("_a(5) _b(9)", ["_a(5) _b(9)"]), ["_b(9) -"]),
        (World("_return(go,odd,2)", ["_return(go,odd,2) _b(5)"], old="_b(5)"), ["_b(5) -"]),
        (World("_return(go,odd,2)", ["_return(go,odd,2)"], old="_b(5)"), ["_return(go,odd,2) -"]),
        (World("_a(5)", ["_return(go,odd,2)"], old="_return(go,odd,2)"), ["_return(go,odd,2) -"]),
        (World("_a(5)", ["_b(5) _c(5)"], old="_b(5) _c(5)"), ["_c(5) -"]),
        (
            World("_a(5)", [f"_request(cancel(1),{STEP})"], requests="cancel(1),5 cancel(2),5"),
            [f"_request(cancel(1),{STEP}) -"],
        ),
        (World("_a(5)", ["_a(5)", "_c(5)"], old="_c(5) _a(5)"), ["_c(5) -", "_a(5) -"]),
        (
            World("_a(5) _b(5)", ["_a(5)", "_b(5)", "_c(5)"], old="_c(5) _a(5) _b(5)"),
            ["_c(5) -", "_a(5) -", "_b(5) -"],
        ),
        (World("_a(5)", ["_return(go,odd,2) _b(5)"], old="_b(5) _return(go,odd,2)"), ["_b(5) -"]),
        (World("_b(5) _return(x,y,2)", ["_b(5)", "_return(x,y,2)"]), ["_return(x,y,2) -", "_b(5) -"]),
        (
            World("_rain _return(x,y,2)", ["_return(x,y,2)", "_request(cancel(1),5)"], requests="cancel(1),5"),
            ["_request(cancel(1),5) -", "_return(x,y,2) -"],
        ),
        # the fewest
        (World("_a(1) _b(2) _c(3)", ["_a(1) _b(2)", "_a(1) _c(3)"]), ["_a(1) _a(5)"]),
        (World("_a(1) _b(2) _c(3)", ["_a(1)", "_c(3)"]), ["_a(1) _a(5)", "_c(3) _c(5)"]),
        # taken for the present where that makes sense, all or some
        (World("_a(1) _b(2)", ["_a(1)", "_b(2)", "_a(5)"]), ["_a(1) -", "_b(2) _b(5)"]),
        (World("_a(1) _b(2)", ["_a(1)", "_b(2)", "_a(5) _b(5)"]), ["_a(1) _a(5)", "_b(2) -"]),
        (World("_a(1)", ["_a(1)", "_a(5)"]), ["_a(1) -"]),
        (World("_a(1) _a(5)", ["_a(1)"]), ["_a(1) _a(5)"]),
        (World("_a(1) _a(2)", ["_a(1)", "_a(2)"]), ["_a(1) _a(5)", "_a(2) _a(5)"]),
        # the first of what was done that can't be
        (World("_a(2)", ["_a(2) go(x)"], done="go,w,1 go,x,2 go,y,3 go,z,4"), ["_a(2) _a(5) go(x)"]),
        (World("_a(2)", ["_a(2) go(w)"], done="go,w,1 go,x,2 go,y,3"), ["_a(2) _a(5) go(w)"]),
        (World("_a(2)", ["_a(2) go(y)"], done="go,w,1 go,x,2 go,y,3 pick,c,3 go,z,4"), ["_a(2) _a(5) go(y) pick(c)"]),
        (World("_a(3)", ["_a(3) go(w)"], done="go,w,1 go,x,2 go,y,3"), ["_a(3) _a(5)"]),
        (World("_a(2)", ["_a(2) go(x) go(z)"], done="go,w,1 go,x,2 go,y,3 go,z,4"), ["_a(2) _a(5) go(z)"]),
        (World("_a(2)", ["_a(2)"], done="go,w,1 go,x,2"), ["_a(2) _a(5)"]),
        (World("_kind(a)", ["_kind(a) go(w)"], done="go,w,1 go,x,2"), ["_kind(a) - go(w)"]),
        (
            World("_a(2) _b(2)", ["_a(2) go(w)", "_b(2) go(x)"], done="go,w,1 go,x,2"),
            ["_a(2) _a(5) go(w)", "_b(2) _b(5) go(x)"],
        ),
        (World("_kind(a)", ["_kind(a) go(w)"], done="go,w,7 go,x,8"), ["_kind(a) - go(w)"]),
        # goals do not count
        (World("_a(2)", ["_a(2)", "g1", "_a(5)"], goals="1"), ["_a(2) -"]),
    ],
)
def test_what_is_doubted(world, changed):
    assert changes(world) == changed
    assert all(world.asked.count(one) <= 3 for one in world.asked), world.asked


@pytest.mark.parametrize(
    ("world", "changed"),
    [
        (World("_a(2) _b(2)", ["_a(2)"], time=0), ["_a(2)? _a(5)", "_b(2)? _b(5)"]),
        (World("_a(2) _b(2)", ["_a(2)", "_b(5)"], time=0), ["_a(2)? -", "_b(2)? -"]),
        (World("_a(2) _b(2)", ["_a(2)", "_b(5)"], time=1), ["_a(2)? -", "_b(2)? -"]),
        (World("_a(2) _b(2)", ["_a(2)", "_b(5)"], time=2), ["_a(2)? _a(5)", "_b(2)? -"]),
        (World("_a(2) _b(2)", ["_a(2) go(w)"], done="go,w,1", time=2), ["_a(2)? _a(5)", "_b(2)? _b(5)"]),
        (World("_a(2) _b(2)", ["_a(2) go(w)"], done="go,w,1", time=3), ["_a(2) _a(5) go(w)"]),
        (World("_a(2)", ["_a(2) go(w)"], done="go,w,1", time=1), ["_a(2) _a(5)"]),
        (World("_a(2)", ["_a(2) go(w)"], done="go,w,1", time=2), ["_a(2) _a(5) go(w)"]),
        (World("_a(2) _a(5) _b(5)", ["_a(2)", "_b(5)"], time=0), ["_a(2)? _a(5)", "_a(5)? -", "_b(5)? -"]),
        # as far as is known
        (World("_a(2) _b(2)", ["_b(2)"], slow=["_a(2)"]), ["_a(2)? _a(5)", "_b(2)? _b(5)"]),
        (World("_a(2)", ["_a(2)"], slow=["_a(5)"]), ["_a(2) -"]),
        (World("_a(2)", ["_a(2)"], refused=["_a(5)"]), ["_a(2) -"]),
        (World("_a(5)", ["_a(5)"], slow=["_b(5)"], old="_b(5)"), ["_b(5)? -", "_a(5)? -"]),
    ],
)
def test_what_is_doubted_where_searches_take_too_long(world, changed):
    assert changes(world) == changed


def test_nothing_helps():
    world = World("_a(2) _b(5) _return(go,odd,2)", ["go(w)"], done="go,w,1", old="_c(5) _a(2)", requests="cancel(1),5")
    assert mend(world, world.case) is None
    assert len(world.asked) == len(set(world.asked)) == 5, "each of what may be doubted was, once"
    world = World("_a(5)", ["go(w)"], done="go,w,1", requests="go(1),6")
    assert mend(world, world.case) is None
    assert world.asked == ["_request(go(1),6) go(w)"], "the last update's answer is known, and requests are no cancels"


def test_of_many_facts_each_is_tried_once():
    facts = [f"_a({number})" for number in range(10, 22)]
    world = World(" ".join([*facts, "_b(5)"]), facts)
    assert len(changes(world)) == 12
    assert len(world.asked) < 20


def test_a_fact_is_stated_once():
    world = World("_a(1) _a(2) _a(5)", ["_a(1)", "_a(2)"])
    assert changes(world) == ["_a(1) _a(5)", "_a(2) _a(5)"]
    assert str(world.updates[-1]).count("_a(5).") == 1
    world = World("_a(2) _a(5) _b(5)", ["_a(2)", "_b(5)"], time=0)
    mend(world, world.case)
    assert world.asked[-1] == "_a(5)", "one was withheld, another is taken for it"


def test_a_solver_that_takes_nothing_any_more():
    world = World("_a(2)", ["_a(2)"], most=2)
    with pytest.raises(UndecidedError):
        mend(world, world.case)


SHUT = Observation(parse_term("_shut(d,2)"), 3)
WENT, TOOK = (action_of(parse_term(f"_action_lib({one},2)")) for one in ("go,den", "take,cup"))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (Change(SHUT, None), "_shut(d,2) contradicts what was done and told before: withheld"),
        (
            Change(
                SHUT._replace(origin="door", original=parse_term("_shut(d,1)")), parse_term("_shut(d,5)"), sure=False
            ),
            "_shut(d,1) from interface door may contradict what was done and told before: taken for cycle 5",
        ),
        (Change(SHUT, None, (WENT,)), "_shut(d,2) contradicts that go(den) was done in cycle 2: withheld"),
        (
            Change(SHUT, None, (WENT, TOOK)),
            "_shut(d,2) contradicts that go(den) and take(cup) were done in cycle 2: withheld",
        ),
    ],
)
def test_changes_in_words(change, text):
    assert str(change) == text


@pytest.mark.parametrize("way", ["slow", "refused"])
def test_it_is_not_known_whether_anything_helps(way):
    world = World("_a(2)", ["_a(2)"], old="_b(5)", done="go,w,1", **{way: ["go(w)"]})
    with pytest.raises(UndecidedError):
        mend(world, world.case)


def test_the_update_as_it_is_taken_at_last():
    world = World("_a(2) _kind(x)", ["_a(2)", "_b(5)"], old="_b(5) _c(5)", done="go,x,4", requests="cancel(1),5")
    assert changes(world) == ["_b(5) -", "_a(2) _a(5)"]
    lines = str(world.updates[-1]).splitlines()
    assert lines == [
        "#step 5 : 7.",
        "#withdraw _b(5).",
        "#closed 4.",
        ":- not _action_lib(go,x,4).",
        "_request(cancel(1),5).",
        "_kind(x).",
        "_a(5).",
        "#end step.",
    ]
