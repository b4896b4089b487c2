"""Whose turn it is: how many goals there is room for, who waits when there is no plan in time, who is not overtaken."""

import pytest
from goal_clients import Clients


def crowd(goals, **limits):
    """Clients of goals 1, 2 and so on, which the program knows as far as there is room."""
    clients = Clients(**limits).add(*range(1, goals + 1))
    clients.feed()
    return clients


# -- room


def test_at_first_there_is_room_for_a_few():
    assert len(crowd(30, search_timeout=10.0).served) == 8
    assert len(crowd(30).served) == 30, "without a limit in time nothing tells that they are too many"


@pytest.mark.parametrize(
    ("seconds", "size"),
    [(0.0, 32), (0.1, 32), (0.375, 32), (1.5, 16), (3.0, 12), (3.2, 11), (6.0, 8), (24.0, 4), (90.0, 4)],
)
def test_so_many_goals_have_room_that_plans_take_the_time_that_they_may(seconds, size):
    """A plan takes four times as long for twice as many goals; four times or half as many there may be at a time."""
    clients = crowd(60, search_timeout=10.0).plan(seconds)
    assert clients.goals.queue.size == size
    assert len(clients.served) == (size if size >= 16 else 8), "goals join once half of the room is free"


def test_goals_join_once_half_of_the_room_is_free():
    clients = crowd(30, search_timeout=10.0).plan(6.0)
    assert clients.end(1, 2, 3).served == [4, 5, 6, 7, 8]
    assert clients.end(4).served == [*range(5, 13)]
    clients.plan(6.0).cancel(*range(13, 31))
    assert clients.end(5, 6, 7, 8).served == [9, 10, 11, 12]
    assert clients.add(40).served == [9, 10, 11, 12, 40], "the room is not full"


def test_goals_join_sooner_where_there_is_room_for_all():
    clients = crowd(11, search_timeout=10.0).plan(6.0)
    assert clients.end(1, 2).served == [3, 4, 5, 6, 7, 8]
    assert clients.end(3).served == [*range(4, 12)]
    soon = crowd(15, search_timeout=10.0).plan(0.1)
    assert soon.served == [*range(1, 16)], "all are known once there is a plan for some"


def test_only_plans_for_new_goals_and_full_rooms_tell_that_there_may_be_more():
    clients = crowd(30, search_timeout=10.0)
    clients.goals.plan_found(None)
    assert len(clients.served) == 8
    few = crowd(7, search_timeout=10.0).plan(0.01).add(*range(8, 30))
    assert len(few.served) == 8
    slow = crowd(7, search_timeout=10.0).plan(24.0)
    assert slow.goals.queue.size == 4


def test_without_a_limit_in_time_it_does_not_count_how_long_a_plan_takes():
    assert crowd(40).put_off(*range(9, 41)).plan(1000.0).goals.queue.size == 10


@pytest.mark.parametrize(("kept", "more"), [(1, 1), (2, 1), (7, 2), (8, 2), (9, 3), (12, 3)])
def test_after_a_loss_there_is_slowly_more_room(kept, more):
    clients = crowd(40)
    clients.put_off(*range(kept + 1, 41))
    assert len(clients.served) == clients.goals.queue.size == kept
    assert clients.plan().goals.queue.size == kept + more


def test_room_never_exceeds_what_is_set():
    clients = crowd(5, at_once=3)
    assert clients.put_off(2, 3).served == [1]
    assert clients.plan().served == [1, 2]
    assert clients.plan().end(1).served == [2, 3, 4]
    assert clients.plan().plan().end(2).served == [3, 4, 5]


def test_a_single_goal_that_took_too_long_says_nothing_of_the_others():
    clients = crowd(8)
    assert [clients.no_plan(*range(1, 9)), clients.no_plan(), clients.no_plan()] == [[5, 6, 7, 8], [3, 4], [2]]
    assert clients.served == [1]
    assert clients.no_plan() == [1]
    assert clients.served == [2, 3, 4, 5, 6, 7, 8], "without a limit in time, for any number"


def test_after_a_single_goal_that_took_too_long_there_is_room_as_at_first():
    clients = crowd(30, search_timeout=10.0).put_off(*range(2, 9))
    assert (clients.served, clients.no_plan()) == ([1], [1])
    assert clients.served == [*range(2, 10)]
    assert clients.plan(0.1).goals.queue.size == 10, "but it grows slowly"


# -- who waits


@pytest.mark.parametrize(
    ("goals", "fresh", "chosen"),
    [
        (4, [], [3, 4]),
        (5, [], [3, 4, 5]),
        (4, [4], [4]),
        (5, [4, 5], [4, 5]),
        (4, [2, 3, 4], [3, 4]),
        (4, [1, 2, 3, 4], [3, 4]),
        (2, [2], [2]),
        (1, [], []),
        (1, [1], []),
    ],
)
def test_the_newest_goals_are_to_wait(goals, fresh, chosen):
    clients = crowd(goals)
    assert clients.no_plan(*fresh) == chosen
    assert clients.waiting == chosen


def test_goals_that_are_being_cancelled_do_not_count():
    clients = crowd(4)
    clients.goals.cancel("g4")
    clients.goals.cancel("g3")
    assert clients.no_plan() == [2]
    assert clients.served == [1, 3, 4]
    clients = crowd(2)
    clients.goals.cancel("g2")
    clients.goals.cancel("g1")
    assert clients.goals.queue.patience == 1
    assert clients.no_plan() == []
    assert clients.goals.queue.patience == 2, "what is left of them has more time"
    assert clients.goals.queue.unhurried


def test_a_goal_that_alone_is_too_much_lets_all_others_go_first():
    clients = crowd(3, at_once=1)
    assert clients.no_plan() == [1]
    assert (clients.served, clients.feed()[-1]) == ([2], "_request(go(2),3)")
    assert clients.end(2).served == [3], "one that was not in vain"
    assert clients.add(4).end(3).served == [4]
    assert clients.end(4).served == [1]
    clients.add(5)
    assert clients.waits(5) == ["first comes go(1)"]
    assert (clients.served, clients.waiting) == ([1], [5]), "what was in vain is planned for alone"
    assert clients.plan().served == [1]
    assert clients.end(1).served == [5]


def test_of_goals_that_were_in_vain_the_one_comes_first_that_was_least_often():
    clients = crowd(3, at_once=1)
    assert [clients.no_plan() for _ in range(4)] == [[1], [2], [], [3]]
    assert clients.served == [1], "the oldest of those that were in vain once"
    assert clients.no_plan() == [1]
    assert clients.served == [2]
    assert [clients.no_plan(), clients.no_plan()] == [[], [2]]
    assert clients.served == [1]


def test_a_goal_that_is_being_cancelled_holds_nobody_off():
    clients = crowd(1)
    clients.no_plan()
    clients.add(2)
    clients.goals.cancel("g1")
    clients.goals.tick(1.0)
    assert clients.served == [1, 2]


def test_goals_that_were_in_vain_give_way_to_one_that_was_not():
    clients = crowd(1)
    queue = clients.goals.queue
    assert clients.no_plan() == []
    assert queue.in_vain() == [], "there is no other"
    clients.add(2)
    assert queue.in_vain() == [clients.goal(1)]
    queue.stay(queue.in_vain())
    assert queue.in_vain() == [], "they cannot be taken out"
    clients.plan()
    assert clients.served == [1, 2]
    assert queue.in_vain() == []
    assert [clients.no_plan(), clients.no_plan()] == [[2], [1]], "perhaps they can by now"


# -- patience


def test_a_search_for_a_single_goal_has_twice_the_time_each_time():
    clients = crowd(1)
    seen = []
    for _ in range(5):
        seen.append(clients.goals.queue.patience)
        clients.no_plan()
    assert seen == [1, 2, 4, 8, 8]
    assert clients.plan().goals.queue.patience == 1


def test_patience_is_that_of_the_goal_that_was_least_often_in_vain():
    clients = crowd(3, at_once=1)
    clients.no_plan()
    assert clients.goals.queue.patience == 1, "goal 2 was never in vain"
    clients.end(2).end(3)
    assert (clients.served, clients.goals.queue.patience) == ([1], 2)
    clients.goals.cancel("g1")
    assert clients.goals.queue.patience == 1


def test_the_next_search_has_more_time_where_no_goal_can_be_taken_out():
    clients = crowd(2)
    queue = clients.goals.queue
    queue.stay(clients.goals.live)
    assert (queue.patience, queue.unhurried) == (2, True)
    queue.stay(clients.goals.live)
    assert queue.patience == 4
    queue.go_on()
    assert (queue.patience, queue.unhurried) == (1, False)
    queue.stay(clients.goals.live)
    assert clients.plan().goals.queue.patience == 1
    queue.stay(clients.goals.live)
    clients.put_off(2)
    assert queue.patience == 1, "there is something else to plan for"


def test_the_next_search_has_ever_more_time_where_nothing_of_an_update_could_be_taken():
    queue, seen = crowd(1).goals.queue, []
    for _ in range(5):
        queue.give_time()
        seen.append(queue.patience)
    assert seen == [2, 4, 8, 16, 32]
    queue.found()
    assert queue.patience == 1


def test_goals_may_still_be_taken_out_where_an_update_came_too_late():
    clients = crowd(2)
    queue = clients.goals.queue
    queue.give_time()
    assert (queue.patience, queue.unhurried) == (2, False)
    queue.stay(clients.goals.live)
    assert queue.unhurried, "all are in hand"
    clients.plan().end(2)
    queue.give_time()
    assert queue.unhurried, "there is no other goal"


def test_a_search_goes_on_until_something_arrives_where_there_is_nothing_else_to_plan_for():
    clients = crowd(1)
    queue = clients.goals.queue
    assert not queue.unhurried
    clients.no_plan()
    assert queue.unhurried
    clients.add(2)
    assert not queue.unhurried, "goal 2 may have its turn"
    queue.stay(queue.in_vain())
    assert queue.unhurried, "not as long as goal 1 is in hand"


def test_what_is_in_hand_bars_nothing_once_it_is_cancelled():
    clients = crowd(2)
    queue = clients.goals.queue
    queue.stay([clients.goal(2)])
    clients.goals.cancel("g2")
    assert clients.no_plan() == []
    assert queue.unhurried
    clients.add(3)
    assert queue.in_vain() == [clients.goal(1)]
    assert not queue.unhurried


def test_no_search_goes_on_without_end_while_another_goal_may_have_its_turn():
    clients = crowd(2, at_once=1)
    queue = clients.goals.queue
    assert [clients.no_plan(), clients.no_plan()] == [[1], []]
    assert (clients.served, queue.patience) == ([2], 2)
    assert not queue.unhurried, "goal 1 was in vain as often: it has its turn before goal 2 is tried a third time"
    assert clients.no_plan() == [2]
    assert (clients.served, queue.patience, queue.unhurried) == ([1], 2, False)
    clients.end(2)
    assert queue.unhurried


# -- overtaking


def test_nobody_newer_comes_once_a_goal_is_overtaken_too_often():
    clients = crowd(2, at_once=2, overtaking_limit=2).add(3, 4, 5)
    assert clients.end(2).served == [1, 3]
    assert clients.end(3).served == [1]
    clients.add(6)
    assert clients.waits(6) == ["first comes go(1)"]
    assert clients.end(1).served == [4, 5]


def test_of_goals_in_one_plan_any_may_be_the_last():
    """A plan for many goals may go past the places of all others first: none of them is overtaken by that."""
    clients = crowd(4, at_once=4, overtaking_limit=2).plan().add(*range(5, 12))
    assert clients.end(2, 3).served == [1, 4, 5, 6]
    assert clients.end(4).served == [1, 5, 6, 7]
    assert clients.end(5).served == [1, 6, 7], "four were planned for together, and four came before it"
    assert clients.plan().end(1).served == [6, 7, 8, 9]


def test_without_a_limit_any_number_comes_before():
    clients = crowd(2, at_once=2).add(*range(3, 30))
    for number in range(2, 20):
        clients.end(number)
    assert clients.served == [1, 20]


def test_goals_that_had_no_turn_overtake_nobody():
    clients = crowd(2, at_once=2, overtaking_limit=1).add(3, 4, 5)
    clients.goals.cancel("g4")
    assert clients.ends()[-1][0] == "g4"
    clients.add(6)
    assert clients.waits(6) == ["2 goals at a time are planned for"]
    assert clients.end(1).served == [2, 3], "older goals overtake nobody"
    assert clients.end(3).served == [2]


def test_one_that_was_in_vain_joins_others_once_it_is_overtaken_too_often():
    clients = crowd(4, at_once=2, overtaking_limit=2)
    clients.end(2, 3)
    clients.add(5, 6, 7)
    assert clients.served == [1], "it is overtaken twice, and planned for alone"
    assert clients.no_plan() == [1]
    assert clients.served == [4, 5]
    assert clients.end(4).served == [5, 6]
    assert clients.end(5).served == [1, 6], "now it is overtaken twice again"
    assert clients.goals.queue.patience == 1, "goal 6 was never in vain"


def test_a_goal_that_is_being_cancelled_does_not_come_first():
    clients = crowd(2, at_once=2, overtaking_limit=1).add(3, 4)
    assert clients.end(2).served == [1]
    clients.goals.cancel("g1")
    clients.goals.tick(1.0)
    assert clients.served == [1, 3]


def test_older_goals_are_let_in_before_the_one_that_comes_first():
    clients = crowd(3, overtaking_limit=1)
    clients.put_off(1)
    clients.end(3)
    clients.goal(1).overtaken, clients.goal(2).overtaken = 0, 2
    clients.goals.tick(1.0)
    clients.add(4)
    assert clients.waits(4) == ["first comes go(2)"]
    clients.goals.cancel("g3")
    clients.plan(8)
    assert clients.served == [1, 2]


# -- goals that the solver could not take


def test_of_goals_that_the_solver_could_not_take_half_come_again():
    clients = Clients().add(1, 2, 3, 4).leave_out()
    assert (clients.served, clients.waiting, clients.fed) == ([1, 2], [3, 4], [])
    assert clients.waits(1) == clients.waits(4) == ["the solver could not take it in time"]
    assert clients.feed() == ["_request(go(1),3)", "_request(go(2),3)"]
    clients.add(5)
    assert clients.waits(5) == ["2 goals at a time are planned for"]


def test_goals_beside_others_come_again_as_soon_as_there_is_room():
    clients = crowd(1).add(2).leave_out()
    assert (clients.served, clients.waiting) == ([1], [2])
    assert clients.end(1).served == [2]
    clients = crowd(1).add(2, 3, 4).leave_out()
    assert clients.served == [1, 2]


def test_a_goal_that_alone_could_not_be_taken_rests_longer_each_time():
    clients, now, rests = Clients().add(1), 100.0, []
    clients.goals.tick(now)
    for _ in range(9):
        clients.leave_out()
        now, rest = now + 1000.0, 0  # the search took its time, which is no rest
        clients.goals.tick(now)
        assert not clients.served
        while not clients.served:
            rest += 5
            clients.goals.tick(now + rest)
        now += rest
        rests.append(rest)
    assert rests == [10, 20, 40, 80, 160, 320, 640, 640, 640]


def test_others_come_while_a_goal_rests_and_none_is_overtaken_by_it():
    clients = Clients(overtaking_limit=1).add(1)
    clients.leave_out().add(2, 3)
    assert clients.served == [2, 3]
    clients.end(2)
    clients.add(4)
    assert clients.served == [3, 4], "goal 1 is overtaken, but rests"
    clients.goals.tick(5.0)
    clients.goals.tick(15.0)
    assert clients.served == [1, 3, 4]


def test_goals_that_were_taken_or_have_ended_are_not_left_out():
    clients = Clients().add(1, 2)
    batch = clients.feeder.next_update(1)
    clients.feeder.taken(batch)
    clients.end(2)
    clients.goals.taken(batch.goals, {batch.update.items[0].head})
    assert clients.fed == ["g1"]
    assert clients.waits(1) == clients.waits(2) == []


# -- the record


# -- searches that are left for what comes


@pytest.mark.parametrize(
    ("cancelled", "why"),
    [("", ""), ("g9", ""), ("g5", ""), ("g2", "a goal was cancelled"), ("g5 g2", "a goal was cancelled")],
)
def test_a_search_is_left_for_cancels_of_goals_that_it_is_for(cancelled, why):
    queue = crowd(5, at_once=3).goals.queue
    assert queue.why_left(set(cancelled.split()), new=True) == why


@pytest.mark.parametrize("end", ["plan", "no_plan", "nothing taken"])
def test_after_a_search_that_was_left_the_next_one_has_its_time(end):
    clients = crowd(3)
    queue = clients.goals.queue
    queue.left = True
    assert queue.why_left({"g2"}, new=True) == ""
    assert queue.why_left({"g1", "g2", "g3"}, new=True) == "a goal was cancelled", "nobody wants the plan"
    {"plan": clients.plan, "no_plan": clients.no_plan, "nothing taken": queue.give_time}[end]()
    assert queue.why_left({"g1", "g2", "g3"}, new=False) == "a goal was cancelled"


def test_a_goal_in_vain_is_left_for_a_new_one_unless_it_comes_first():
    clients = crowd(1, overtaking_limit=2)
    queue = clients.goals.queue
    assert queue.why_left((), new=True) == ""
    clients.no_plan()
    assert [queue.why_left((), new) for new in (False, True)] == ["", "a goal has come"]
    clients.goal(1).overtaken = 2
    assert queue.why_left((), new=True) == ""


def test_a_single_new_goal_that_is_too_much_is_tried_alone_next():
    clients = crowd(3)
    clients.add(4).feed()
    assert clients.no_plan(4) == [4]
    clients.add(5).feed()
    assert clients.plan().end(1).plan().served == [2, 3, 5], "others go first"
    assert clients.end(2, 3, 5).served == [4]
