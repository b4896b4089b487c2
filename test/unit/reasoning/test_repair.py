"""Which observations are redated or withheld, with a planner that only knows conflicts."""

import pytest
from clingo import parse_term

from rosoclingo.oclingo import SolverError, Statement, StreamUpdate, commitment
from rosoclingo.oclingo.progression.updates import CloseCycles
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Reply
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.hypotheses import Impasse
from rosoclingo.reasoning.input_feeder import Clock
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.repair import Change, repair
from rosoclingo.reasoning.stream_planner import Halt

#: The cycle that the update starts.
STEP = 5


class World:
    """A planner of an update with facts ``new``, after ``old`` ones and actions that were ``done``, all as text.

    No set in ``conflicts``, of facts, actions and goals (g1, ...), can hold; of ``slow`` sets this is unknown. No
    solver accepts the ``refused`` ones, nor anything after ``most`` searches. ``time`` is the number of searches
    until time runs out. The update's own facts are among the observations already, as with the core.
    """

    lookahead = 7

    def __init__(self, new="", conflicts=(), **others):
        self.new, self.old = (
            [Observation(parse_term(one), 2) for one in text.split()] for text in (new, others.pop("old", ""))
        )
        self.done = [action_of(parse_term(f"_action_lib({one})")) for one in others.pop("done", "").split()]
        self.requests = [parse_term(f"_request({one})") for one in others.pop("requests", "").split()]
        self.goals = [Goal(f"g{one}", parse_term(f"go({one})")) for one in others.pop("goals", "")]
        for one in self.goals:
            one.feed(3)
        self.conflicts = [set(one.split()) for one in conflicts]
        self.slow = [set(one.split()) for one in others.pop("slow", ())]
        self.refused = [set(one.split()) for one in others.pop("refused", ())]
        self.time, self.most = others.pop("time", None), others.pop("most", None)
        assert not others
        self.asked, self.left = [], None
        facts = [one.atom for one in self.new]
        items = [
            CloseCycles(4, 4),
            *(commitment(one.atom) for one in self.done[-1:]),
            *map(Statement, self.requests + facts),
        ]
        self.last_update = StreamUpdate(STEP, 7, tuple(items))

    def watch(self):
        self.left = self.time
        return lambda: Halt("time is over") if self.left is not None and self.left <= 0 else None

    @property
    def impasse(self):
        goals, old = tuple(reversed(self.goals)), tuple(reversed(self.old))
        clock = Clock(lambda name, arity: {"_kind": None, "_next": 1}.get(name, 0))
        return Impasse(STEP + 1, goals, old, self.watch, 7, tuple(self.new), tuple(self.done), clock)

    def before_update(self):
        return self

    def restarted(self):
        return self

    def inquire(self, update, assumable, disabled, steps):
        """Answer as the planner does; facts that are neither actions nor requests stay as they are."""
        assert steps == self.lookahead
        assert disabled <= assumable
        requests = {parse_term(f"_request(go({one.key[1:]}),3)"): one.key for one in self.goals}
        actions = {one.atom: f"{one.interface}({one.parameter})" for one in self.done}
        names = {one: requests.get(one) or actions.get(one) or str(one) for one in assumable}
        heads = {item.head for item in update.items if isinstance(item, Statement) and item.head is not None}
        cancels = {one for one in heads if update.step == STEP + 1 and one.name == "_request"}
        assumed = {str(one) for one in (heads - cancels) | {one.atom for one in [*self.new, *self.old]}}
        assumed.update(map(str, self.requests), actions.values(), requests.values())
        assumed -= {names[one] for one in disabled} | {
            f"g{one.arguments[0].arguments[0]}" for one in cancels - disabled
        }
        return self.reply(assumed, names)

    def reply(self, assumed, names):
        self.left = None if self.left is None else self.left - 1
        self.asked.append(" ".join(sorted(assumed)))
        if any(one <= assumed for one in self.refused) or len(self.asked) - 1 == self.most:
            raise SolverError("refused by the test")
        conflict = next((one for one in self.conflicts if one <= assumed), None)
        if conflict is not None:
            return Reply(False, core=frozenset(fact for fact, name in names.items() if name in conflict))
        return Reply(None if any(one <= assumed for one in self.slow) else True)

    def corrected(self, gone, new):
        assumed = {str(one.atom) for one in [*self.new, *self.old] if one.atom not in gone}
        assumed |= {str(one) for one in self.requests if one not in gone} | {str(one) for one in new}
        assumed |= {f"{one.interface}({one.parameter})" for one in self.done if one.atom not in gone}
        self.last = assumed
        return self, self.reply(assumed, {})


def changes(world):
    """Return the fate of the suspected observations: the fact with which each is replaced, and what it denies."""
    found = repair(world, world.impasse)
    return [
        f"{one.observation.atom}{'' if one.sure else '?'} {one.redated or '-'}"
        + "".join(f" {action.interface}({action.parameter})" for action in one.against)
        for one in found.changes
    ]


@pytest.mark.parametrize(
    ("world", "changed"),
    [
        # late facts are suspected before new ones, these before older ones, and the ends of actions last
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
        # the fewest facts
        (World("_a(1) _b(2) _c(3)", ["_a(1) _b(2)", "_a(1) _c(3)"]), ["_a(1) _a(5)"]),
        (World("_a(1) _b(2) _c(3)", ["_a(1)", "_c(3)"]), ["_a(1) _a(5)", "_c(3) _c(5)"]),
        # redated to the present where that is sensible, all or some
        (World("_a(1) _b(2)", ["_a(1)", "_b(2)", "_a(5)"]), ["_a(1) -", "_b(2) _b(5)"]),
        (World("_a(1) _b(2)", ["_a(1)", "_b(2)", "_a(5) _b(5)"]), ["_a(1) _a(5)", "_b(2) -"]),
        (World("_a(1)", ["_a(1)", "_a(5)"]), ["_a(1) -"]),
        (World("_a(1) _a(5)", ["_a(1)"]), ["_a(1) _a(5)"]),
        (World("_a(1) _a(2)", ["_a(1)", "_a(2)"]), ["_a(1) _a(5)", "_a(2) _a(5)"]),
        (World("_c(5)", ["_b(2)"], old="_b(2)"), ["_b(2) _b(5)"]),
        (World("_c(5)", ["_b(2)", "_b(5) _c(5)"], old="_b(2)"), ["_b(2) -"]),
        # the first of the executed actions that is impossible
        (World("_a(2)", ["_a(2) go(x)"], done="go,w,1 go,x,2 go,y,3 go,z,4"), ["_a(2) _a(5) go(x)"]),
        (World("_a(2)", ["_a(2) go(w)"], done="go,w,1 go,x,2 go,y,3"), ["_a(2) _a(5) go(w)"]),
        (World("_a(2)", ["_a(2) go(y)"], done="go,w,1 go,x,2 go,y,3 pick,c,3 go,z,4"), ["_a(2) _a(5) go(y)"]),
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
def test_repair_suspects_the_expected_observations(world, changed):
    assert changes(world) == changed
    assert all(world.asked.count(one) <= 3 for one in world.asked), world.asked


@pytest.mark.parametrize(
    ("world", "changed"),
    [
        (World("_a(2) _b(2)", ["_a(2)"], time=0), ["_a(2)? -", "_b(2)? -"]),
        (World("_a(2) _b(2)", ["_a(2)", "_b(5)"], time=0), ["_a(2)? -", "_b(2)? -"]),
        (World("_a(2) _b(2)", ["_a(2)", "_b(5)"], time=1), ["_a(2)? _a(5)", "_b(2)? -"]),
        (World("_a(2) _b(2)", ["_a(2) go(w)"], done="go,w,1", time=2), ["_a(2)? _a(5)", "_b(2)? _b(5)"]),
        (World("_a(2) _b(2)", ["_a(2) go(w)"], done="go,w,1", time=3), ["_a(2) _a(5) go(w)"]),
        (World("_a(2)", ["_a(2) go(w)"], done="go,w,1", time=1), ["_a(2) _a(5)"]),
        (World("_a(2)", ["_a(2) go(w)"], done="go,w,1", time=2), ["_a(2) _a(5) go(w)"]),
        (World("_a(2) _a(5) _b(5)", ["_a(2)", "_b(5)"], time=0), ["_a(2)? -", "_a(5)? -", "_b(5)? -"]),
        # as far as the searches tell
        (World("_a(2) _b(2)", ["_b(2)"], slow=["_a(2)"]), ["_a(2)? _a(5)", "_b(2)? _b(5)"]),
        (World("_a(2)", ["_a(2)"], slow=["_a(5)"]), ["_a(2) -"]),
        (World("_a(2)", ["_a(2)"], refused=["_a(5)"]), ["_a(2) -"]),
        (World("_a(5)", ["_a(5)"], slow=["_b(5)"], old="_b(5)"), ["_b(5)? -", "_a(5)? -"]),
    ],
)
def test_repair_with_searches_that_take_too_long(world, changed):
    assert changes(world) == changed


def test_repair_reports_that_nothing_helps():
    world = World("_a(2) _b(5) _return(go,odd,2)", ["go(w)"], done="go,w,1", old="_c(5) _a(2)", requests="cancel(1),5")
    assert repair(world, world.impasse) is None
    assert len(world.asked) == 1, "it does not matter which facts are doubted"
    world = World("_a(5)", ["go(w)"], done="go,w,1", requests="go(1),6")
    assert repair(world, world.impasse) is None
    assert world.asked == ["_request(go(1),6) go(w)"], "the last update's answer is known, and requests are not cancels"


def test_repair_tries_each_of_many_facts_once():
    facts = [f"_a({number})" for number in range(10, 22)]
    world = World(" ".join([*facts, "_b(5)"]), facts)
    assert len(changes(world)) == 12
    assert len(world.asked) < 20


def test_repair_ends_if_solver_accepts_nothing():
    world = World("_a(2)", ["_a(2)"], most=2)
    with pytest.raises(UndecidedError):
        repair(world, world.impasse)


SHUT = Observation(parse_term("_shut(d,2)"), 3)
WENT, TOOK = (action_of(parse_term(f"_action_lib({one},2)")) for one in ("go,den", "take,cup"))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (Change(SHUT, None), "_shut(d,2) contradicts the history: withheld"),
        (
            Change(
                SHUT._replace(origin="door", original=parse_term("_shut(d,1)")), parse_term("_shut(d,5)"), sure=False
            ),
            "_shut(d,1) from interface door possibly contradicts the history: redated to cycle 5",
        ),
        (Change(SHUT, None, (WENT,)), "_shut(d,2) contradicts that go(den) was done in cycle 2: withheld"),
        (
            Change(SHUT, None, (WENT, TOOK)),
            "_shut(d,2) contradicts that go(den) and take(cup) were done in cycle 2: withheld",
        ),
    ],
)
def test_repair_describes_changes_in_words(change, text):
    assert str(change) == text


@pytest.mark.parametrize("way", ["slow", "refused"])
def test_repair_is_undecided_after_incomplete_searches(way):
    world = World("_a(2)", ["_a(2)"], old="_b(5)", done="go,w,1", **{way: ["go(w)"]})
    with pytest.raises(UndecidedError):
        repair(world, world.impasse)
