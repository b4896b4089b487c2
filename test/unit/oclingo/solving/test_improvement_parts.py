"""Which parts of a plan are free in which question, and when nothing is left to try."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.oclingo.solving import improvement
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.improvement import Improvement
from rosoclingo.oclingo.solving.stream_log import Plan, cycle_of


def actions(*cycles):
    return frozenset(parse_atom(f"_action_lib(go,x,{cycle})") for cycle in cycles)


def plan(horizon, *cycles):
    return Plan(actions(*cycles), horizon)


def found(horizon, *cycles):
    return Search(True, (frozenset(), actions(*cycles)), horizon)


NONE, OPEN = Search(False), Search(None)


class Asked:
    """A grounding that gives the ``replies`` to what it is asked, then leaves all open.

    What was asked is noted as text: 2..5/100 +1 -3 for these horizons, so many conflicts, and the cycles whose actions
    are given as true and as false; "alone" where the program's advice does not count.
    """

    def __init__(self, *replies, horizon=99, cycles=(), advises=False):
        self.program = SimpleNamespace(advises=advises)
        self.replies, self.horizon, self.cycles, self.asked, self.looked = list(replies), horizon, cycles, [], []

    def actions(self, first, last):
        self.looked.append((first, last))
        return sorted(actions(*(one for one in self.cycles if first <= one <= last)))

    def search(self, models, halt, first, last, given=(), conflicts=None, best=True, advised=True):
        assert (models, best) == (1, False)
        marks = sorted((cycle_of(one), "-+"[value]) for one, value in given)
        assert len({cycle for cycle, _ in marks}) == len(marks)
        signs = [f"{sign}{cycle}" for cycle, sign in marks]
        self.asked.append(" ".join([f"{first}..{last}/{conflicts}", *signs, *([] if advised else ["alone"])]))
        return self.replies.pop(0) if self.replies else OPEN

    def halt_after(self, questions):
        return lambda: len(self.asked) >= questions


@pytest.fixture(autouse=True)
def put_offs(monkeypatch):
    """No action is put off and no far shorter plan asked for, where a test does not say otherwise.

    Nor is a question asked again that a stop cut off, and plans stay as they are found: test_trimming.py has that.
    Returns what was drawn from: weights, and things.
    """
    drawn = []

    class Second:
        """Draws the second of several things."""

        def __init__(self, seed):
            assert isinstance(seed, int), "a run can be repeated"

        def choices(self, things, weights):
            drawn.append([round(one, 2) for one in weights])
            return [things[-1]]

        def choice(self, things):
            return things[1] if len(things) > 1 else things[0]

    monkeypatch.setattr(improvement, "Random", Second)
    monkeypatch.setattr(improvement, "PUT_OFFS", 0)
    monkeypatch.setattr(improvement, "SHARES", ())
    monkeypatch.setattr(improvement, "TIMES_CUT", 0)
    monkeypatch.setattr(improvement, "trimmed", lambda found, *rest: found)
    return drawn


@pytest.mark.parametrize(
    ("horizon", "replies", "asked"),
    [
        (41, [], ["1..11/400", "1..21/200", "1..40/100 +19 +40"]),
        (33, [], ["1..9/400", "1..17/200", "1..32/100 +19 +40"]),
        (32, [], ["1..31/100 +19 +40"]),
        (41, [NONE], ["1..11/400", "12..40/100 +19 +40"]),
        (61, [NONE], ["1..16/400", "17..39/200", "17..60/100 +19 +40"]),
        (41, [OPEN, NONE], ["1..11/400", "1..21/200", "22..40/100 +19 +40"]),
    ],
    ids=["long", "just", "short", "none so short", "still long", "nor half as long"],
)
def test_of_a_long_plan_first_any_far_shorter_one_is_asked_for(monkeypatch, horizon, replies, asked):
    monkeypatch.undo()
    monkeypatch.setattr(improvement, "PUT_OFFS", 0)
    solver = Asked(*replies)
    assert Improvement(plan(horizon, 2, 5, 20, 41), 1, 1).run(solver, solver.halt_after(len(asked))) is None
    assert solver.asked == asked


def test_a_far_shorter_plan_is_asked_for_without_advice_too(monkeypatch):
    monkeypatch.undo()
    asked = Asked(advises=True)
    assert Improvement(plan(41, 2, 5, 20, 41), 1, 1).run(asked, asked.halt_after(4)) is None
    assert asked.asked == ["1..11/400", "1..11/400 alone", "1..21/200", "1..21/200 alone"]


def test_without_advice_many_steps_are_not_asked_for(monkeypatch):
    monkeypatch.undo()
    asked = Asked(advises=True, horizon=999)
    assert Improvement(plan(301, 2, 5, 20, 301), 1, 1).run(asked, asked.halt_after(4)) is None
    assert asked.asked[:3] == ["1..76/400", "1..76/400 alone", "1..151/200"]
    assert "alone" not in asked.asked[3]


def test_a_far_shorter_plan_is_taken(monkeypatch):
    monkeypatch.setattr(improvement, "SHARES", (4, 2))
    asked = Asked(found(9, 2, 9), OPEN)
    assert Improvement(plan(41, 2, 5, 20, 41), 1, 1).run(asked, asked.halt_after(9)).horizon == 9
    assert asked.asked == ["1..11/400"]


def test_windows_overlap_by_half():
    asked = Asked()
    tried = Improvement(plan(41, 2, 5, 20, 41), 1, 1)
    assert tried.run(asked, asked.halt_after(6)) is None
    assert asked.asked == [
        "1..40/100 +19 +40",
        "1..40/100 +2 +5 +40",
        "1..40/100 +2 +5 +40",
        "1..40/100 +2 +5 +20",
        "1..40/100 +2 +5 +20",
        "1..40/200 +40",  # 2..25
    ]


@pytest.mark.parametrize(
    ("cycle", "given"), [(2, ""), (17, ""), (18, " +17"), (19, " +18")], ids=["first", "last", "behind", "far"]
)
def test_what_lies_behind_a_window_is_done_one_step_earlier(cycle, given):
    asked = Asked()
    Improvement(plan(30, cycle), 1, 1).run(asked, asked.halt_after(1))
    assert asked.asked == [f"1..29/100{given}"]


@pytest.mark.parametrize(("horizon", "given"), [(17, ""), (18, " +17")])
def test_a_window_to_the_end_leaves_the_end_free(horizon, given):
    asked = Asked()
    Improvement(plan(horizon, horizon), 1, 1).run(asked, asked.halt_after(1))
    assert asked.asked == [f"1..{horizon - 1}/100{given}"]


def test_rounds_that_bring_nothing_are_followed_by_harder_ones_until_all_was_tried_hard():
    asked = Asked()
    tried = Improvement(plan(5, 3), 1, 1)
    assert tried.run(asked, asked.halt_after(50)) is None
    assert asked.asked == [f"1..4/{most}" for most in (100, 200, 400, 800, 1600, 3200, 6400, 12800, 20000)]
    assert tried.run(asked, asked.halt_after(50)) is None
    assert len(asked.asked) == 9


def test_windows_grow_until_one_is_all_of_the_plan(monkeypatch):
    monkeypatch.setattr(improvement, "MOST_CONFLICTS", 100)
    asked = Asked()
    Improvement(plan(38, *range(2, 39)), 1, 1).run(asked, asked.halt_after(50))
    behind = [len(one.split()) - 1 for one in asked.asked]
    assert behind == [21, 21, 21, 24, 32, 13, 13, 24, 36, 1, 18, 36, 0, 27]


@pytest.mark.parametrize(("size", "questions"), [(3, 6), (4, 2), (5, 2)])
def test_a_window_as_long_as_what_is_to_come_is_all_of_it(size, questions, monkeypatch):
    monkeypatch.setattr(improvement, "MOST_CONFLICTS", 100)
    monkeypatch.setattr(improvement, "SIZE", size)
    asked = Asked()
    Improvement(plan(5, 5), 1, 1).run(asked, asked.halt_after(50))
    assert len(asked.asked) == questions


def test_a_shorter_plan_is_taken_and_the_next_round_is_as_hard():
    better = found(5, 1, 2, 3, 4, 5)
    asked = Asked(OPEN, better)
    tried = Improvement(plan(6, 1, 4, 6), 1, 1)
    assert tried.run(asked, asked.halt_after(50)) == better
    assert tried.goes_on(plan(5, 1, 2, 3, 4, 5), 1, 1)
    assert tried.run(asked, asked.halt_after(4)) is None
    assert asked.asked == ["1..5/100", "1..5/200", "1..4/200", "1..4/400"]


def test_what_was_done_or_runs_is_given_and_nothing_else_is_done_up_to_the_present():
    asked = Asked(cycles=(0, 1, 2, 3, 4))
    Improvement(plan(9, 1, 3, 7), 3, 3).run(asked, asked.halt_after(1))
    assert asked.looked == [(1, 3)]
    assert asked.asked == ["3..8/100 +1 -2 +3"]
    asked = Asked(cycles=(2, 3, 4))
    Improvement(plan(9, 7), 3, 5).run(asked, asked.halt_after(1))
    assert asked.looked == [(3, 3)]
    assert asked.asked == ["5..8/100 -3"]


def test_only_what_is_ground_is_asked_for():
    asked = Asked(horizon=6)
    Improvement(plan(9, 7), 1, 1).run(asked, asked.halt_after(1))
    assert asked.asked == ["1..6/100"]


@pytest.mark.parametrize("horizon", [9, 17])
def test_where_no_shorter_plan_does_the_same_now_there_is_nothing_to_try(horizon):
    asked = Asked(NONE)
    tried = Improvement(plan(horizon, 1, horizon), 1, 1)
    assert tried.run(asked, asked.halt_after(50)) is None
    assert asked.asked == [f"1..{horizon - 1}/100"]


def test_that_a_part_brings_nothing_says_little_of_the_others(monkeypatch):
    monkeypatch.setattr(improvement, "SIZE", 2)
    asked = Asked(NONE, NONE)
    Improvement(plan(9, 2, 9), 1, 1).run(asked, asked.halt_after(4))
    assert len(asked.asked) == 4


@pytest.mark.parametrize("horizon", [1, 2, 3])
def test_no_plan_is_shorter_than_one_without_steps_to_come(horizon):
    asked = Asked()
    tried = Improvement(plan(horizon), 1, 2)
    assert tried.run(asked, asked.halt_after(1)) is None
    assert len(asked.asked) == max(0, horizon - 2)


@pytest.mark.parametrize("before", [0, 1])
def test_a_plan_that_gets_too_short_on_the_way_is_left_at_once(before):
    asked = Asked(*[OPEN] * before, found(2, 2))
    tried = Improvement(plan(3, 3), 1, 2)
    assert tried.run(asked, asked.halt_after(50)) == found(2, 2)
    assert tried.run(asked, asked.halt_after(50)) is None
    assert len(asked.asked) == before + 1


@pytest.mark.parametrize(("horizon", "questions"), [(3, 0), (4, 1)])
def test_a_plan_that_gets_too_short_between_two_windows_is_left_at_once(horizon, questions, monkeypatch):
    monkeypatch.setattr(improvement, "SIZE", 2)
    better = found(horizon, *range(2, horizon + 1))
    asked = Asked(OPEN, better)
    tried = Improvement(plan(6, 6), 1, 3)
    assert tried.run(asked, asked.halt_after(50)) == better
    assert tried.run(asked, asked.halt_after(3)) is None
    assert len(asked.asked) == 2 + questions


def test_it_goes_on_with_the_same_plan_alone():
    tried = Improvement(plan(9, 1, 4, 9), 1, 1)
    asked = Asked()
    tried.run(asked, asked.halt_after(1))
    assert not tried.goes_on(plan(8, 1, 4, 9), 2, 2)
    assert not tried.goes_on(plan(9, 1, 5, 9), 2, 2)
    assert tried.goes_on(plan(9, 4, 9), 2, 2), "what is over does not matter"
    tried.run(asked, asked.halt_after(2))
    assert tried.goes_on(plan(9, 4, 9), 5, 5)
    tried.run(asked, asked.halt_after(3))
    assert asked.asked == ["1..8/100", "2..8/200", "5..8/400"]


def test_a_stop_ends_it_before_the_next_question():
    asked = Asked()
    assert Improvement(plan(9, 9), 1, 1).run(asked, lambda: True) is None
    assert asked.asked == []


def test_windows_begin_behind_the_present_where_that_has_moved_on():
    asked = Asked()
    tried = Improvement(plan(60, *range(2, 61)), 1, 1)
    tried.run(asked, asked.halt_after(1))
    tried.goes_on(plan(60, *range(2, 61)), 30, 30)
    tried.run(asked, asked.halt_after(2))
    assert asked.asked[-1].split()[1:] == [f"+{cycle}" for cycle in range(46, 60)]


def test_actions_are_put_off_for_some_steps_with_all_behind_them_free(monkeypatch):
    monkeypatch.setattr(improvement, "PUT_OFFS", 2)
    monkeypatch.setattr(improvement, "SPANS", (1, 3))
    asked = Asked(OPEN, NONE, OPEN, OPEN, advises=True)
    Improvement(plan(9, 2, 5, 7), 1, 1).run(asked, asked.halt_after(4))
    assert asked.asked == ["1..8/100", *["1..8/25 +2 -5 -6 -7"] * 2, "1..8/200"]


def test_nothing_is_put_off_where_nothing_is_done(put_offs, monkeypatch):
    monkeypatch.setattr(improvement, "PUT_OFFS", 2)
    asked = Asked(advises=True)
    Improvement(plan(9, 1), 1, 1).run(asked, asked.halt_after(3))
    assert asked.asked == ["1..8/100", "1..8/200", "1..8/400"]
    assert put_offs == []


def test_what_was_of_use_is_put_off_more_often(put_offs, monkeypatch):
    monkeypatch.setattr(improvement, "PUT_OFFS", 1)
    better = found(8, *range(2, 9))
    asked = Asked(OPEN, OPEN, OPEN, better, advises=True)
    tried = Improvement(plan(9, 2, 5, 7), 1, 1)
    assert tried.run(asked, asked.halt_after(50)) == better
    assert tried.run(asked, asked.halt_after(8)) is None
    assert put_offs == [[1.0], [0.5], [0.67], [0.5]]


def test_a_plan_that_gets_too_short_while_actions_are_put_off_is_left_at_once(monkeypatch):
    monkeypatch.setattr(improvement, "PUT_OFFS", 3)
    asked = Asked(OPEN, found(2, 2), advises=True)
    tried = Improvement(plan(3, 3), 1, 2)
    assert tried.run(asked, asked.halt_after(50)) == found(2, 2)
    assert tried.run(asked, asked.halt_after(50)) is None
    assert len(asked.asked) == 2


def test_without_advice_windows_alone_are_asked_for(put_offs, monkeypatch):
    monkeypatch.setattr(improvement, "PUT_OFFS", 2)
    asked = Asked()
    Improvement(plan(9, 2, 5, 7), 1, 1).run(asked, asked.halt_after(3))
    assert asked.asked == ["1..8/100", "1..8/200", "1..8/400"]
    assert put_offs == []


def test_without_advice_small_windows_come_again_with_more_conflicts(monkeypatch):
    monkeypatch.setattr(improvement, "MOST_CONFLICTS", 800)
    sizes = {}
    for advises in (False, True):
        asked = Asked(advises=advises)
        Improvement(plan(20, *range(2, 21)), 1, 1).run(asked, asked.halt_after(50))
        sizes[advises] = [len(one.split()) > 1 for one in asked.asked if one.split()[0].endswith("/400")]
    assert any(sizes[False]), "parts of the plan are given"
    assert not sizes[True][0], "all of it is free"


def test_a_question_that_a_stop_cut_off_is_asked_again(monkeypatch):
    monkeypatch.setattr(improvement, "TIMES_CUT", 2)
    asked = Asked()
    tried = Improvement(plan(9, 1, 4, 9), 1, 1)
    for number in range(1, 5):
        tried.run(asked, asked.halt_after(number))
    assert asked.asked == ["1..8/100", "1..8/100", "1..8/100", "1..8/200"]


def test_what_is_left_of_the_plan_is_tried_again_in_each_step(monkeypatch):
    monkeypatch.setattr(improvement, "MOST_CONFLICTS", 100)
    asked = Asked()
    tried = Improvement(plan(9, 9), 1, 1)
    for step in (1, 1, 2, 2, 3):
        assert tried.goes_on(plan(9, 9), step, step)
        assert tried.run(asked, asked.halt_after(50)) is None
    assert asked.asked == ["1..8/100", "2..8/100", "3..8/100"]
