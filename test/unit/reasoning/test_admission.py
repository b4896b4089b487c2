"""Admission: how many goals fit, which of them are deferred without a plan in time, and fairness to old goals."""

import pytest
from core_scripts import perform, scripts
from goal_clients import HEARING, crowd

#: The initial number of goals, their limits, and the events.
TIMED = {"search_timeout": 10.0}
ADMISSION = {
    # room
    "at first for a few": (30, TIMED, "has 1-8; plan old; has 1-8"),
    "goals join once half of it is free": (30, TIMED, """
        plan 6; end 1-3; has 4-8; end 4; has 5-12; plan 6; cancel 13-30; end 5-8; has 9-12; add 40; has 9-12 40"""),
    "each goal joins at once if actions go on": (30, {**TIMED, "text": HEARING + "#external _running/3."}, """
        plan 6; end 1-3; has 4-11; end 4; has 5-12"""),
    "all join once there is a fast plan": (15, TIMED, "plan 0.1; has 1-15"),
    "never more than is set": (5, {"at_once": 3}, """
        put_off 2 3; has 1; plan; has 1 2; plan; end 1; has 2-4; plan; plan; end 2; has 3-5"""),
    "a single new goal is tried alone next": (3, {}, """
        add 4; feed; no_plan 4 new 4; add 5; feed; plan; end 1; plan; has 2 3 5; end 2 3 5; has 4"""),
    # wait
    **{f"of {goals}, with {fresh or 'none'} new: {chosen or 'none'}": (goals, {}, f"""
        no_plan {chosen} {"new" if fresh else ""} {fresh}; lacks {chosen}""")
       for goals, fresh, chosen in [
           (5, "", "3-5"), (4, "4", "4"), (4, "1-4", "3 4"), (1, "1", "")]},
    "cancelled goals do not count": (4, {}, "cancel 4; cancel 3; no_plan 2; has 1 3 4"),
    "a failed single goal lets all others go first": (3, {"at_once": 1}, """
        no_plan 1; has 2; end 2; has 3; add 4; end 3; has 4; end 4; has 1; add 5; tells 5 go(1) has priority; has 1
        lacks 5; plan; has 1; end 1; has 5"""),
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
        add 3-5; end 2; has 1 3; end 3; has 1; add 6; tells 6 go(1) has priority; end 1; has 4 5"""),
    "of goals in one plan any can be the last": (4, {"at_once": 4, "overtaking_limit": 2}, """
        plan; add 5-11; end 2 3; has 1 4-6; end 4; has 1 5-7; end 5; has 1 6 7; plan; end 1; has 6-9"""),
    "no limit": (2, {"at_once": 2}, "add 3-29;" + "".join(f"end {one};" for one in range(2, 20)) + "has 1 20"),
    "a failed goal joins others once it is overtaken too often": (4, {"at_once": 2, "overtaking_limit": 2}, """
        end 2 3; add 5-7; has 1; no_plan 1; has 4 5; end 4; has 5 6; end 5; has 1 6; patience 1"""),
    # dropped
    "half of them come again": (0, {}, """
        add 1-4; leave_out; has 1 2; lacks 3 4; tells 1 the solver did not accept it in time
        tells 4 the solver did not accept it in time
        feed; add 5; tells 5 at most 2 goals are planned for at a time"""),
    "alone it comes again after the others": (0, {"at_once": 1, "overtaking_limit": 1}, """
        add 1-3; leave_out; has 2; pauses no; leave_out; has 3; end 3; has 1; patience 2; leave_out; has 2; end 2; has 1
        patience 4; pauses no"""),
    "alone without others it comes again after a pause": (0, {}, """
        tick 100; add 1; leave_out; has 1; patience 2; pauses yes; tick 109; pauses yes; tick 110; pauses no
        leave_out; pauses yes; add 2; pauses no; has 1; lacks 2"""),
}  # fmt: skip


@scripts(ADMISSION)
def test_admission_follows_the_script(row):
    goals, limits, script = row
    perform(crowd(goals, **limits), script)


@pytest.mark.parametrize(
    ("seconds", "size"),
    [(0.1, 32), (1.5, 16), (3.2, 11), (6.0, 8), (90.0, 4)],
)
def test_admission_window_follows_planning_time(seconds, size):
    """A plan for twice as many goals takes four times as long; the window then grows fourfold or shrinks to half."""
    clients = crowd(60, **TIMED).plan(seconds)
    assert clients.goals.queue.size == size
    assert len(clients.served) == (size if size >= 16 else 8), "goals join once half of the room is free"


# -- searches that arrivals interrupt


@pytest.mark.parametrize(
    ("cancelled", "why"),
    [("", ""), ("g9", ""), ("g5", ""), ("g2", "a goal was cancelled"), ("g5 g2", "a goal was cancelled")],
)
def test_admission_stops_search_if_its_goals_are_cancelled(cancelled, why):
    queue = crowd(5, at_once=3).goals.queue
    assert queue.why_interrupted(set(cancelled.split()), new=True) == why


def test_admission_drops_hopeless_goal_for_new_one_unless_first():
    clients = crowd(1, overtaking_limit=2)
    queue = clients.goals.queue
    assert queue.why_interrupted((), new=True) == ""
    clients.no_plan()
    assert [queue.why_interrupted((), new) for new in (False, True)] == ["", "a goal has arrived"]
    clients.goal(1).overtaken = 2
    assert queue.why_interrupted((), new=True) == ""


@pytest.mark.parametrize("end", ["plan", "no_plan 2 3"])
def test_admission_gives_full_time_after_a_stopped_search(end):
    clients = crowd(3)
    queue = clients.goals.queue
    queue.interrupted = True
    assert queue.why_interrupted({"g2"}, new=True) == ""
    assert queue.why_interrupted({"g1", "g2", "g3"}, new=True) == "a goal was cancelled", "nobody wants the plan"
    perform(clients, end)
    assert queue.why_interrupted({"g1", "g2", "g3"}, new=False) == "a goal was cancelled"
