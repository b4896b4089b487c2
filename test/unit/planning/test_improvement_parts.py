"""Which parts of a plan are free in which question, and when nothing is left to try."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply, StoppedError
from rosoclingo.planning.strategies import improve
from rosoclingo.planning.strategies.improve import Improvement, Part


def actions(*cycles):
    return frozenset(parse_atom(f"_action_lib(go,x,{cycle})") for cycle in cycles)


def plan(horizon, *cycles):
    return Plan(actions(*cycles), horizon)


def found(horizon, *cycles):
    return Reply(True, (frozenset(), actions(*cycles)), horizon)


NONE = Reply(False)


class Asked:
    """What an improvement knows of its grounding; replies to its questions, of which the rest stay open.

    Questions are noted as text: 2..5/100 +1 -3 for these horizons, so many conflicts, and the cycles whose actions are
    given as true and as false; "alone" where the program's advice does not count.
    """

    def __init__(self, *replies, horizon=99, cycles=(), advises=False, step=1):
        self.program, self.step, self.horizon = SimpleNamespace(advises=advises), step, horizon
        self.replies, self.cycles, self.asked, self.looked, self.stopped = list(replies), cycles, [], [], False

    def actions(self, first, last):
        self.looked.append((first, last))
        return sorted(actions(*(one for one in self.cycles if first <= one <= last)))

    def is_stopped(self):
        return self.stopped

    def run(self, improvement, most=50, cuts=False):
        """Let it go on until so many questions were asked of all; the last one is interrupted if the stop ``cuts``."""
        strategy = improvement.run(self)
        self.stopped = len(self.asked) >= most
        try:
            question = next(strategy)
            while True:
                self._note(question)
                self.stopped = len(self.asked) >= most
                reply = self.replies.pop(0) if self.replies else UNKNOWN
                question = strategy.throw(StoppedError()) if self.stopped and cuts else strategy.send(reply)
        except StopIteration as end:
            return end.value

    def _note(self, question):
        assert (question.models, question.best) == (1, False)
        marks = sorted((cycle_of(one), "-+"[value]) for one, value in question.given)
        assert len({cycle for cycle, _ in marks}) == len(marks)
        signs = [f"{sign}{cycle}" for cycle, sign in marks]
        limits = f"{question.first}..{question.last}/{question.conflicts}"
        self.asked.append(" ".join([limits, *signs, *([] if question.advised else ["alone"])]))


@pytest.fixture(autouse=True)
def drawn(monkeypatch):
    """No action is put off and no far shorter plan asked for where a test does not say otherwise.

    Plans stay as they are found: test_trimming.py has that. Returns what was drawn from: weights, and things.
    """
    weighted = []

    class Second:
        """Draws the second of several things."""

        def __init__(self, seed):
            assert isinstance(seed, int), "a run can be repeated"

        def choices(self, things, weights):
            weighted.append([round(one, 2) for one in weights])
            return [things[-1]]

        def choice(self, things):
            return things[1] if len(things) > 1 else things[0]

        def random(self):
            return 0.5

    def as_found(found, *_rest):
        return found
        yield

    monkeypatch.setattr(improve, "Random", Second)
    monkeypatch.setattr(improve, "trimmed", as_found)
    monkeypatch.setattr(improve, "PUT_OFFS", 0)
    monkeypatch.setattr(improve, "SHARES", ())
    return weighted


LONG = (2, 5, 20, 41)


@pytest.mark.parametrize(
    ("horizon", "replies", "advises", "asked"),
    [
        (41, [], False, ["1..11/400", "1..21/200", "1..40/100 +19 +40"]),
        (33, [], False, ["1..9/400", "1..17/200", "1..32/100 +19 +40"]),
        (32, [], False, ["1..31/100 +19 +40"]),
        (41, [NONE], False, ["1..11/400", "12..40/100 +19 +40"]),
        (61, [NONE], False, ["1..16/400", "17..39/200", "17..60/100 +19 +40"]),
        (41, [UNKNOWN, NONE], False, ["1..11/400", "1..21/200", "22..40/100 +19 +40"]),
        (41, [], True, ["1..11/400", "1..11/400 alone", "1..21/200", "1..21/200 alone"]),
        (301, [], True, ["1..76/400", "1..76/400 alone", "1..151/200", "1..300/100 +19 +40"]),
    ],
    ids=["long", "just", "short", "none", "still long", "nor half as long", "without advice too", "too long for that"],
)
def test_of_a_long_plan_first_any_far_shorter_one_is_asked_for(monkeypatch, horizon, replies, advises, asked):
    monkeypatch.setattr(improve, "SHARES", (4, 2))
    solver = Asked(*replies, advises=advises, horizon=999)
    assert solver.run(Improvement(plan(horizon, *LONG), 1, 1), len(asked)) is None
    assert solver.asked == asked


def test_a_far_shorter_plan_is_taken(monkeypatch):
    monkeypatch.setattr(improve, "SHARES", (4, 2))
    asked = Asked(found(9, 2, 9))
    assert asked.run(Improvement(plan(41, *LONG), 1, 1)).horizon == 9
    assert asked.asked == ["1..11/400"]


def test_windows_overlap_by_half():
    asked = Asked()
    assert asked.run(Improvement(plan(41, *LONG), 1, 1), 6) is None
    assert asked.asked == [
        "1..40/100 +19 +40",
        "1..40/100 +2 +5 +40",
        "1..40/100 +2 +5 +40",
        "1..40/100 +2 +5 +20",
        "1..40/100 +2 +5 +20",
        "1..40/200 +40",  # 2..25
    ]


@pytest.mark.parametrize(
    ("horizon", "cycle", "given"),
    [(30, 2, ""), (30, 17, ""), (30, 18, " +17"), (30, 19, " +18"), (17, 17, ""), (18, 18, " +17")],
    ids=["first", "last", "behind", "far", "to the end", "not quite"],
)
def test_what_lies_behind_a_window_is_done_one_step_earlier(horizon, cycle, given):
    asked = Asked()
    asked.run(Improvement(plan(horizon, cycle), 1, 1), 1)
    assert asked.asked == [f"1..{horizon - 1}/100{given}"]


def test_an_action_is_put_off_for_some_steps_and_all_is_free_from_there_on():
    go, take, back = (
        parse_atom(text) for text in ("_action_lib(go,a,1)", "_action_lib(take,b,2)", "_action_lib(go,c,3)")
    )
    later = [parse_atom(f"_action_lib(take,b,{cycle})") for cycle in (2, 3, 4)]
    given = Part(2, put_off=take, span=3).given(Plan(frozenset([go, take, back]), 3))
    assert given == [(go, True), *((one, False) for one in later)]


def test_rounds_that_bring_nothing_are_followed_by_harder_ones_until_all_was_tried_hard():
    asked = Asked()
    tried = Improvement(plan(5, 3), 1, 1)
    assert asked.run(tried) is None
    assert asked.asked == [f"1..4/{most}" for most in (100, 200, 400, 800, 1600, 3200, 6400, 12800, 20000)]
    assert asked.run(tried) is None
    assert len(asked.asked) == 9


def test_windows_grow_until_one_is_all_of_the_plan(monkeypatch):
    monkeypatch.setattr(improve, "MOST_CONFLICTS", 100)
    asked = Asked()
    asked.run(Improvement(plan(38, *range(2, 39)), 1, 1))
    behind = [len(one.split()) - 1 for one in asked.asked]
    assert behind == [21, 21, 21, 24, 32, 13, 13, 24, 36, 1, 18, 36, 0, 27]


@pytest.mark.parametrize(("size", "questions"), [(3, 6), (4, 2), (5, 2)])
def test_a_window_as_long_as_what_is_to_come_is_all_of_it(size, questions, monkeypatch):
    monkeypatch.setattr(improve, "MOST_CONFLICTS", 100)
    monkeypatch.setattr(improve, "SIZE", size)
    asked = Asked()
    asked.run(Improvement(plan(5, 5), 1, 1))
    assert len(asked.asked) == questions


def test_a_shorter_plan_is_taken_and_the_next_round_is_as_hard():
    better = found(5, 1, 2, 3, 4, 5)
    asked = Asked(UNKNOWN, better)
    tried = Improvement(plan(6, 1, 4, 6), 1, 1)
    assert asked.run(tried) == better
    assert tried.goes_on(plan(5, 1, 2, 3, 4, 5), 1, 1)
    assert asked.run(tried, 4) is None
    assert asked.asked == ["1..5/100", "1..5/200", "1..4/200", "1..4/400"]


@pytest.mark.parametrize(
    ("cycles", "plan", "place", "step", "looked", "asked"),
    [
        ((0, 1, 2, 3, 4), plan(9, 1, 3, 7), (3, 3), 3, (1, 3), "3..8/100 +1 -2 +3"),
        ((2, 3, 4), plan(9, 7), (3, 5), 3, (3, 3), "5..8/100 -3"),
        ((2, 3, 4), plan(9, 7), (3, 3), 2, (2, 3), "3..8/100 -2 -3"),
    ],
    ids=["from the plan on", "the present one", "from the grounding on"],
)
def test_what_was_done_or_runs_is_given_and_nothing_else_up_to_the_present(cycles, plan, place, step, looked, asked):
    solver = Asked(cycles=cycles, step=step)
    solver.run(Improvement(plan, *place), 1)
    assert solver.looked == [looked]
    assert solver.asked == [asked]


def test_only_what_is_ground_is_asked_for():
    asked = Asked(horizon=6)
    asked.run(Improvement(plan(9, 7), 1, 1), 1)
    assert asked.asked == ["1..6/100"]


@pytest.mark.parametrize("horizon", [9, 17])
def test_where_no_shorter_plan_does_the_same_now_there_is_nothing_to_try(horizon):
    asked = Asked(NONE)
    assert asked.run(Improvement(plan(horizon, 1, horizon), 1, 1)) is None
    assert asked.asked == [f"1..{horizon - 1}/100"]


def test_that_a_part_brings_nothing_says_little_of_the_others(monkeypatch):
    monkeypatch.setattr(improve, "SIZE", 2)
    asked = Asked(NONE, NONE)
    asked.run(Improvement(plan(9, 2, 9), 1, 1), 4)
    assert len(asked.asked) == 4


@pytest.mark.parametrize("horizon", [1, 2, 3])
def test_no_plan_is_shorter_than_one_without_steps_to_come(horizon):
    asked = Asked()
    assert asked.run(Improvement(plan(horizon), 1, 2), 1) is None
    assert len(asked.asked) == max(0, horizon - 2)


@pytest.mark.parametrize(
    ("plan", "first", "replies", "options", "questions"),
    [
        (plan(3, 3), 2, [found(2, 2)], {}, 0),
        (plan(3, 3), 2, [UNKNOWN, found(2, 2)], {}, 0),
        (plan(6, 6), 3, [UNKNOWN, found(3, 2, 3)], {"SIZE": 2}, 0),
        (plan(6, 6), 3, [UNKNOWN, found(4, 2, 3, 4)], {"SIZE": 2}, 1),
        (plan(3, 3), 2, [UNKNOWN, found(2, 2)], {"PUT_OFFS": 3}, 0),
    ],
    ids=["at once", "later", "between windows", "not yet", "while actions are put off"],
)
def test_a_plan_that_gets_too_short_on_the_way_is_left_at_once(monkeypatch, plan, first, replies, options, questions):
    for name, value in options.items():
        monkeypatch.setattr(improve, name, value)
    asked, tried, count = Asked(*replies, advises="PUT_OFFS" in options), Improvement(plan, 1, first), len(replies)
    assert asked.run(tried) == replies[-1]
    assert asked.run(tried, count + 1) is None
    assert len(asked.asked) == count + questions


def test_it_goes_on_with_the_same_plan_alone():
    tried = Improvement(plan(9, 1, 4, 9), 1, 1)
    asked = Asked()
    asked.run(tried, 1)
    assert not tried.goes_on(plan(8, 1, 4, 9), 2, 2)
    assert not tried.goes_on(plan(9, 1, 5, 9), 2, 2)
    assert tried.goes_on(plan(9, 4, 9), 2, 2), "what is over does not matter"
    asked.run(tried, 2)
    assert tried.goes_on(plan(9, 4, 9), 5, 5)
    asked.run(tried, 3)
    assert asked.asked == ["1..8/100", "2..8/200", "5..8/400"]


def test_windows_begin_behind_the_present_where_that_has_moved_on():
    asked = Asked()
    tried = Improvement(plan(60, *range(2, 61)), 1, 1)
    asked.run(tried, 1)
    tried.goes_on(plan(60, *range(2, 61)), 30, 30)
    asked.run(tried, 2)
    assert asked.asked[-1].split()[1:] == [f"+{cycle}" for cycle in range(46, 60)]


def test_actions_are_put_off_for_some_steps_with_all_behind_them_free(monkeypatch):
    monkeypatch.setattr(improve, "PUT_OFFS", 2)
    monkeypatch.setattr(improve, "SPANS", (1, 3))
    asked = Asked(UNKNOWN, NONE, advises=True)
    asked.run(Improvement(plan(9, 2, 5, 7), 1, 1), 4)
    assert asked.asked == ["1..8/100", *["1..8/25 +2 -5 -6 -7"] * 2, "1..8/200"]


def test_what_was_of_use_is_put_off_more_often(drawn, monkeypatch):
    monkeypatch.setattr(improve, "PUT_OFFS", 1)
    better = found(8, *range(2, 9))
    asked = Asked(UNKNOWN, UNKNOWN, UNKNOWN, better, advises=True)
    tried = Improvement(plan(9, 2, 5, 7), 1, 1)
    assert asked.run(tried) == better
    assert asked.run(tried, 8) is None
    assert drawn == [[1.0], [0.5], [0.67], [0.5]]


@pytest.mark.parametrize(("cycles", "advises"), [((1,), True), ((2, 5, 7), False)], ids=["nothing to do", "no advice"])
def test_windows_alone_are_asked_for_where_putting_off_does_not_help(drawn, monkeypatch, cycles, advises):
    monkeypatch.setattr(improve, "PUT_OFFS", 2)
    asked = Asked(advises=advises)
    asked.run(Improvement(plan(9, *cycles), 1, 1), 3)
    assert asked.asked == ["1..8/100", "1..8/200", "1..8/400"]
    assert drawn == []


def test_without_advice_small_windows_come_again_with_more_conflicts(monkeypatch):
    monkeypatch.setattr(improve, "MOST_CONFLICTS", 800)
    sizes = {}
    for advises in (False, True):
        asked = Asked(advises=advises)
        asked.run(Improvement(plan(20, *range(2, 21)), 1, 1))
        sizes[advises] = [len(one.split()) > 1 for one in asked.asked if one.split()[0].endswith("/400")]
    assert any(sizes[False]), "parts of the plan are given"
    assert not sizes[True][0], "all of it is free"


def test_a_question_that_a_stop_interrupted_is_asked_again(monkeypatch):
    monkeypatch.setattr(improve, "TIMES_CUT", 2)
    asked = Asked()
    tried = Improvement(plan(9, 1, 4, 9), 1, 1)
    for number in range(1, 5):
        assert asked.run(tried, number, cuts=True) is None
    assert asked.asked == ["1..8/100", "1..8/100", "1..8/100", "1..8/200"]


def test_what_is_left_of_the_plan_is_tried_again_in_each_step(monkeypatch):
    monkeypatch.setattr(improve, "MOST_CONFLICTS", 100)
    asked = Asked()
    tried = Improvement(plan(9, 9), 1, 1)
    for step in (1, 1, 2, 2, 3):
        assert tried.goes_on(plan(9, 9), step, step)
        assert asked.run(tried) is None
    assert asked.asked == ["1..8/100", "2..8/100", "3..8/100"]
