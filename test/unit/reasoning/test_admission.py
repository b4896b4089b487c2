"""Admission: how many goals fit, which of them are deferred without a plan in time, and fairness to old goals."""

import pytest
from core_scripts import perform, scripts

from rosoclingo.oclingo import parse_term
from rosoclingo.reasoning.admission import Admission
from rosoclingo.reasoning.goals import Goal, GoalEvent
from rosoclingo.reasoning.settings import CoreSettings


def numbers_of(words):
    """Return the numbers of words such as 3 and 5-8."""
    ends = [list(map(int, str(word).split("-"))) for word in words]
    return [number for end in ends for number in range(end[0], end[-1] + 1)]


class Clients:
    """Clients of goals 1, 2 and so on; the words of scripts have goals as numbers, or ranges such as 3-8."""

    def __init__(self, number, at_once=0, overtaking_limit=0, search_timeout=0.0, batches=True):
        settings = CoreSettings(goals_at_once=at_once, overtaking_limit=overtaking_limit, search_timeout=search_timeout)
        self.goals = {}
        self.queue = Admission(lambda: [*self.goals.values()], settings, batches)
        self.add(*range(1, number + 1))

    def admit(self):
        for goal in self.queue.admit():
            goal.waits = False

    def all(self, words):
        return [self.goals[number] for number in numbers_of(words)]

    def add(self, *goals):
        for number in numbers_of(goals):
            self.goals[number] = Goal(f"g{number}", parse_term(f"go({number})"), waits=True)
            self.admit()

    def end(self, *goals):
        for number in numbers_of(goals):
            self.queue.end(self.goals[number])
            del self.goals[number]
            self.admit()

    def cancel(self, *goals):
        for number in numbers_of(goals):
            if self.goals[number].waits:
                self.end(number)
            else:
                self.goals[number].apply(GoalEvent.CANCEL_REQUEST)

    def plan(self, seconds=0.0):
        """Find a plan for all goals within a number of seconds, or for old ones."""
        for goal in self.queue.served:
            goal.request_cycle = 1
        self.queue.plan_found(None if seconds == "old" else float(seconds))
        self.admit()

    def no_plan(self, *words):
        """Find no plan in time if the goals after ``new`` are new; expect the goals before it to be queued."""
        place = words.index("new") if "new" in words else len(words)
        chosen = self.queue.too_many(self.all(words[place + 1 :]))
        assert chosen == self.all(words[:place])
        if chosen:
            self.put_off(*words[:place])
        else:
            self.queue.keep(chosen)

    def put_off(self, *goals):
        """Defer these goals."""
        self.queue.defer(self.all(goals))
        self.admit()

    def stay(self, *goals):
        """Bar these goals from deferral."""
        self.queue.keep(self.all(goals))

    def has(self, *goals):
        """Expect the program to have these goals."""
        assert self.queue.served == self.all(goals)

    def lacks(self, *goals):
        """Expect these goals to be queued."""
        assert self.queue.waiting == self.all(goals)

    def patience(self, factor, unhurried=None):
        """Expect this factor of a search's time, and ``unhurried`` or ``hurried``."""
        assert self.queue.patience == int(factor)
        assert unhurried is None or self.queue.unhurried == (unhurried == "unhurried")

    def in_vain(self, *goals):
        """Expect these goals to give way to another."""
        assert self.queue.yielding() == self.all(goals)


#: The initial number of goals, their limits, and the events.
TIMED = {"search_timeout": 10.0}
ADMISSION = {
    # room
    "at first for a few": (30, TIMED, "has 1-8; plan old; has 1-8"),
    "goals join once half of it is free": (30, TIMED, """
        plan 6; end 1-3; has 4-8; end 4; has 5-12; plan 6; cancel 13-30; end 5-8; has 9-12; add 40; has 9-12 40"""),
    "each goal joins at once if actions go on": (30, {**TIMED, "batches": False}, """
        has 1-4; plan 1.5; end 1-3; has 4-11; end 4; has 5-12"""),
    "all join once there is a fast plan": (15, TIMED, "plan 0.1; has 1-15"),
    "never more than is set": (5, {"at_once": 3}, """
        put_off 2 3; has 1; plan; has 1 2; plan; end 1; has 2-4; plan; plan; end 2; has 3-5"""),
    "a single new goal is tried alone next": (3, {}, """
        add 4; no_plan 4 new 4; add 5; plan; end 1; plan; has 2 3 5; end 2 3 5; has 4"""),
    # wait
    **{f"of {goals}, with {fresh or 'none'} new: {chosen or 'none'}": (goals, {}, f"""
        no_plan {chosen} {"new" if fresh else ""} {fresh}; lacks {chosen}""")
       for goals, fresh, chosen in [
           (5, "", "3-5"), (4, "4", "4"), (4, "1-4", "3 4"), (1, "1", "")]},
    "cancelled goals do not count": (4, {}, "cancel 4; cancel 3; no_plan 2; has 1 3 4"),
    "a failed single goal lets all others go first": (3, {"at_once": 1}, """
        no_plan 1; has 2; end 2; has 3; add 4; end 3; has 4; end 4; has 1; add 5; has 1; lacks 5; plan; has 1; end 1
        has 5"""),
    "failed goals give way to a new one": (1, {}, """
        no_plan; in_vain; add 2; in_vain 1; stay 1; in_vain; plan; has 1 2; in_vain; no_plan 2; no_plan 1"""),
    # patience
    "doubles for a single goal": (1, {}, """
        patience 1; no_plan; patience 2; no_plan; patience 4; no_plan; patience 8; no_plan; patience 8; plan; patience 1
        """),
    "no search without end while another goal can have its turn": (2, {"at_once": 1}, """
        no_plan 1; no_plan; has 2; patience 2 hurried; no_plan 2; has 1; patience 2 hurried; end 2; patience 2 unhurried
        """),
    # overtaking
    "nobody newer comes once a goal is overtaken too often": (2, {"at_once": 2, "overtaking_limit": 2}, """
        add 3-5; end 2; has 1 3; end 3; has 1; end 1; has 4 5"""),
    "of goals in one plan any can be the last": (4, {"at_once": 4, "overtaking_limit": 2}, """
        plan; add 5-11; end 2 3; has 1 4-6; end 4; has 1 5-7; end 5; has 1 6 7; plan; end 1; has 6-9"""),
    "no limit": (2, {"at_once": 2}, "add 3-29;" + "".join(f"end {one};" for one in range(2, 20)) + "has 1 20"),
    "a failed goal joins others once it is overtaken too often": (4, {"at_once": 2, "overtaking_limit": 2}, """
        end 2 3; add 5-7; has 1; no_plan 1; has 4 5; end 4; has 5 6; end 5; has 1 6; patience 1"""),
}  # fmt: skip


@scripts(ADMISSION)
def test_admission_follows_the_script(row):
    goals, limits, script = row
    perform(Clients(goals, **limits), script)


@pytest.mark.parametrize(
    ("seconds", "size"),
    [(0.1, 32), (1.5, 16), (3.2, 11), (6.0, 8), (90.0, 4)],
)
def test_admission_window_follows_planning_time(seconds, size):
    """A plan for twice as many goals takes four times as long; the window then grows fourfold or shrinks to half."""
    clients = Clients(60, **TIMED)
    clients.plan(seconds)
    assert clients.queue.size == size
    assert len(clients.queue.served) == (size if size >= 16 else 8), "goals join once half of the room is free"


# -- searches that arrivals interrupt


@pytest.mark.parametrize(("cancelled", "why"), [("", ""), ("g5 g9", ""), ("g5 g2", "a goal was cancelled")])
def test_admission_stops_search_if_its_goals_are_cancelled(cancelled, why):
    assert Clients(5, at_once=3).queue.why_interrupted(cancelled.split(), new=True) == why


def test_admission_drops_hopeless_goal_for_new_one_unless_first():
    clients = Clients(1, overtaking_limit=2)
    assert clients.queue.why_interrupted((), new=True) == ""
    clients.no_plan()
    assert [clients.queue.why_interrupted((), new) for new in (False, True)] == ["", "a goal has arrived"]
    clients.goals[1].overtaken = 2
    assert clients.queue.why_interrupted((), new=True) == ""


@pytest.mark.parametrize("end", ["plan", "no_plan 2 3"])
def test_admission_gives_full_time_after_a_stopped_search(end):
    clients = Clients(3)
    queue = clients.queue
    queue.interrupted = True
    assert queue.why_interrupted({"g2"}, new=True) == ""
    assert queue.why_interrupted({"g1", "g2", "g3"}, new=True) == "a goal was cancelled", "nobody wants the plan"
    perform(clients, end)
    assert queue.why_interrupted({"g1", "g2", "g3"}, new=False) == "a goal was cancelled"
