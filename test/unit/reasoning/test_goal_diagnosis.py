"""Which goals are aborted and why, with a planner that only knows conflicts and slow searches."""

from itertools import combinations

import pytest
from clingo import parse_term
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import SolveOutcome, SolverError, SolveResult, Statement
from rosoclingo.oclingo.progression.updates import Withdraw
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Reply
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.hypotheses import Impasse, Way
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.recovery import FEW, recover
from rosoclingo.reasoning.stream_planner import Halt

#: The cycle that is to start.
STEP = 5

#: The horizon bound.
STEPS = 10

SATISFIABLE, UNSATISFIABLE, INTERRUPTED = SolveOutcome.SATISFIABLE, SolveOutcome.UNSATISFIABLE, SolveOutcome.INTERRUPTED


def goal(number):
    found = Goal(str(number), parse_term(f"go({number})"))
    found.feed(3)
    return found


def seen(letter):
    return Observation(parse_term(f"_seen({letter})"), 2)


def name(fact):
    """Return the goal or observation that a fact is about."""
    return str(fact.arguments[0].arguments[0] if fact.name == "_request" else fact.arguments[0])


def request(number):
    return parse_term(f"_request(go({number}),3)")


class World:
    """A planner without a plan for goals 1, 2, ... and observations a, b, ..., and the recovery's question.

    No set in ``conflicts``, such as "1 2 a", can hold together. ``slow`` are sets of remaining goals for which the
    search is interrupted; ``refused`` are those for which the solver refuses the update. ``ways`` gives the end of a
    search without goals, by whether goals are withheld. With ``cores`` a refuted question returns one conflict.
    """

    def __init__(self, goals=3, observations="", conflicts=(), **others):
        self.goals = [goal(number) for number in range(1, goals + 1)]
        self.observations = [seen(letter) for letter in observations]
        self.conflicts = [set(one.split()) for one in conflicts]
        self.lookahead, self.steps = STEPS, others.pop("steps", {})
        self.slow = [set(one) for one in others.pop("slow", ())]
        self.refused = [set(one) for one in others.pop("refused", ())]
        self.ways = others.pop("ways", {})
        self.late = [set(one) for one in others.pop("late", ())]
        self.slow_without = others.pop("slow_without", {})
        self.time = others.pop("time", None)
        self.cores = others.pop("cores", False)
        assert not others
        self.asked, self.updates, self.without, self.left = [], [], [], 0

    def watch(self):
        self.left = self.time
        return lambda: Halt("time is over") if self.left is not None and self.left <= 0 else None

    @property
    def impasse(self):
        newest = [tuple(reversed(things)) for things in (self.goals, self.observations)]
        return Impasse(STEP, *newest, self.watch, STEPS)

    def restarted(self, without=frozenset()):
        return TrialPlanner(self, without)

    def outcome(self, goals, observations, withheld, steps):
        self.left = None if self.left is None else self.left - 1
        self.asked.append(" ".join(sorted(goals | observations)))
        if goals in self.refused:
            raise SolverError("refused by the test")
        again = self.asked.count(self.asked[-1]) > 1
        unseen = any(goals == set(some) and one not in observations for one, some in self.slow_without.items())
        if goals in self.slow or (again and goals in self.late) or unseen:
            return INTERRUPTED
        if not goals and withheld in self.ways:
            return self.ways[withheld]
        if steps >= self.steps.get("".join(sorted(goals)), steps + 1):
            return SATISFIABLE
        return UNSATISFIABLE if any(one <= goals | observations for one in self.conflicts) else SATISFIABLE


class TrialPlanner:
    """A trial planner derived from that of the world."""

    def __init__(self, world, without):
        self._world, self._without, self.lookahead = world, without, world.lookahead
        world.without.append(without)

    def update(self, update):
        withdrawn = {item.atom for item in update.items if isinstance(item, Withdraw)}
        assert withdrawn <= self._without
        outcome = self._outcome(update, self._without, withdrawn, self.lookahead)
        return SolveResult(outcome, (), STEP + 3, STEP)

    def inquire(self, update, doubted, disabled, steps):
        assert self._without == frozenset()
        assert disabled <= doubted
        requests = {request(one.key) for one in self._world.goals}
        outcome = self._outcome(update, disabled, disabled & requests, steps)
        satisfiable = None if outcome is INTERRUPTED else outcome is SATISFIABLE
        if satisfiable or not self._world.cores:
            return Reply(satisfiable, core=frozenset() if satisfiable else doubted)
        reported = set(self._world.asked[-1].split())
        whole = next((one for one in self._world.conflicts if one <= reported), None)
        return Reply(False, core=frozenset(fact for fact in doubted if whole is None or name(fact) in whole))

    def _outcome(self, update, disabled, withdrawn, steps):
        world = self._world
        assert update.step == STEP
        world.updates.append(update)
        reported = {item.head for item in update.items if isinstance(item, Statement)} - disabled
        gone = {str(atom.arguments[0].arguments[0]) for atom in reported | withdrawn}
        seen = {str(one.atom.arguments[0]) for one in world.observations if one.atom not in disabled}
        return world.outcome({one.key for one in world.goals} - gone, seen, bool(withdrawn), steps)


def lost(world):
    """Return the aborted goals, each with its ordered reasons, and ? where these are not certain."""
    found = recover(world, world.impasse)
    assert found.met
    return [
        " ".join(
            [loss.goal.key + ("" if loss.sure else "?")]
            + [one.key for one in loss.together]
            + [str(one.atom.arguments[0]) for one in loss.observations]
        )
        for loss in found.unmet
    ]


def text(update):
    return " ".join(str(update).split())


def test_recovery_cancels_oldest_goals_first_in_starting_cycle():
    world = World(3, "a", ways={True: UNSATISFIABLE, False: UNSATISFIABLE})
    assert recover(world, world.impasse) is None
    assert [text(update) for update in world.updates] == [
        "#step 5. _request(cancel(1),5). _request(cancel(2),5). _request(cancel(3),5). #end step.",
        "#step 5. #end step.",
    ]


def test_recovery_withdraws_goals_in_order():
    goals = " ".join(map(str, range(1, 13)))
    world = World(12, conflicts=goals.split(), ways={False: UNSATISFIABLE})
    withdrawn = [item.atom for item in recover(world, world.impasse).update.items]
    assert withdrawn == sorted(withdrawn)
    assert len(withdrawn) == 12


@pytest.mark.parametrize("withheld", [False, True])
def test_recovery_returns_a_planner_with_its_update(withheld):
    world = World(3, conflicts=["1 3"], ways={False: UNSATISFIABLE} if withheld else {})
    found = recover(world, world.impasse)
    assert found.way is (Way.WITHHELD if withheld else Way.CANCELLED)
    assert isinstance(found.planner, TrialPlanner)
    assert found.result.horizon == STEP + 3
    mark = "#withdraw _request(go(3),3)." if withheld else "_request(cancel(3),5)."
    assert text(found.update) == f"#step 5. {mark} #end step."


@pytest.mark.parametrize(
    ("conflicts", "losses"),
    [
        (["3"], ["3"]),
        (["1 3"], ["3 1"]),
        (["1 2 3"], ["3 1 2"]),
        (["1", "2", "3"], ["1", "2", "3"]),
        (["2 3", "1 3"], ["3 2"]),
        (["1", "2 3 b"], ["1", "3 2 b"]),
        (["3 a b"], ["3 a b"]),
        (["1 2 a", "3 b"], ["2 1 a", "3 b"]),
        (["3 a b c d"], ["3 a b c d"]),  # their number, if it is certain
    ],
)
@pytest.mark.parametrize("ways", [{}, {False: UNSATISFIABLE}])  # the goals are cancelled, or cancelling does not help
def test_recovery_aborts_fewest_goals_and_reports_conflicts(conflicts, losses, ways):
    assert lost(World(3, "abcd", conflicts, ways=ways)) == losses


@given(st.lists(st.frozensets(st.sampled_from("1234"), min_size=1, max_size=3), min_size=1, max_size=4))
def test_recovery_reasons_name_only_goals_that_stay(conflicts):
    losses = [one.split() for one in lost(World(4, conflicts=map(" ".join, conflicts)))]
    gone = {one[0] for one in losses}
    choices = [set(some) for size in range(5) for some in combinations("4321", size)]
    assert gone == next(some for some in choices if all(some & one for one in conflicts)), "few, the newest first"
    for one in losses:
        assert set(one) & gone == {one[0]}
        assert set(one) in conflicts


@pytest.mark.parametrize("slow", [True, False])
def test_recovery_is_undecided_if_a_search_is_incomplete(slow):
    world = World(2, ways={slow: INTERRUPTED, not slow: UNSATISFIABLE})
    with pytest.raises(UndecidedError):
        recover(world, world.impasse)
    assert len(world.asked) == 2
    world = World(2, conflicts=["1"], ways={False: INTERRUPTED, True: SATISFIABLE})
    assert recover(world, world.impasse)


def test_recovery_without_goals_aborts_nothing():
    world = World(0)
    assert recover(world, world.impasse) is None
    assert world.asked == []


def test_recovery_with_goals_requires_answer_without_them():
    world = World(2, ways={True: UNSATISFIABLE, False: UNSATISFIABLE})
    assert recover(world, world.impasse) is None


@pytest.mark.parametrize(
    ("goals", "others"),
    [
        (2, {"refused": [""]}),
        (3, {"conflicts": ["3"], "refused": ["12"]}),
        (4, {"conflicts": ["1 3"], "time": 2}),
        (4, {"conflicts": ["1 3"], "slow": ["124"]}),
        (3, {"conflicts": ["1 2", "1 3"], "late": ["23"]}),  # the second search takes too long
        (3, {"conflicts": ["1 3"], "slow": ["23"]}),  # it can be 2 as well
    ],
)
def test_recovery_aborts_only_goals_proven_impossible(goals, others):
    world = World(goals, **others)
    with pytest.raises(UndecidedError):
        recover(world, world.impasse)


def test_recovery_keeps_goals_that_can_be_met_in_turn():
    """Within the steps of both; a single goal has only its own steps."""
    for steps, met in ((2 * STEPS, True), (2 * STEPS + 1, False)):
        world = World(3, conflicts=["1 3"], steps={"13": steps})
        if met:
            with pytest.raises(UndecidedError):
                recover(world, world.impasse)
        else:
            assert lost(world) == ["3 1"]
    assert lost(World(3, conflicts=["3"], steps={"3": STEPS + 1})) == ["3"]


@pytest.mark.parametrize("ways", [{}, {False: UNSATISFIABLE}])
def test_recovery_skips_searches_implied_by_unsat_core(ways):
    world = World(8, "ab", conflicts=["5 a", "6", "7", "8"], cores=True, ways=ways)
    assert lost(world) == ["5 a", "6", "7", "8"]
    asked = [set(one.split()) for one in world.asked]
    for number, one in enumerate(asked):
        conflict = next((some for some in world.conflicts if some <= one), None)
        if conflict is not None:
            assert not any(conflict <= later for later in asked[number + 1 :]), conflict


def test_recovery_replans_long_after_an_old_choice():
    world = World(4, conflicts=["1 2", "3 4", "1 4"])
    found = recover(world, world.impasse)
    gone = {loss.goal.key for loss in found.unmet}
    assert (
        text(found.update)
        == "#step 5. " + "".join(f"_request(cancel({key}),5). " for key in sorted(gone)) + "#end step."
    )
    assert len(gone) == 2


@pytest.mark.parametrize(
    ("observations", "time", "losses"),
    [
        ("abcd", 6, ["4? b c d"]),
        ("abcde", 6, ["4?"]),  # too many facts that are perhaps irrelevant
        ("abcd", 7, ["4 b c"]),  # the time for the reasons begins once the goals are known
    ],
)
def test_recovery_has_time_limits_for_goals_and_reasons(observations, time, losses):
    world = World(4, observations, conflicts=["4 b c"], time=time)
    assert lost(world) == losses
    assert FEW == 3


def test_recovery_marks_unproven_reasons_as_uncertain():
    assert lost(World(3, "a", conflicts=["1 3 a"], slow_without={"a": "13"})) == ["3? 1"]
