import json

import pytest

from rosoclingo.oclingo import Statement, StreamUpdate, parse_atom, parse_term, parse_update
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.input_feeder import Batch, Clock, InputFeeder, requests_of
from rosoclingo.reasoning.keywords import action_of


def goal(text):
    return Goal(text, parse_term(text), lambda _goal, _event: None)


def action(text):
    return action_of(parse_atom(text))


def words(text):
    return text.split()


def test_order_is_commitments_requests_facts():
    feeder = InputFeeder()
    feeder.add_fact(parse_atom("_return(a,x,4)"))
    feeder.add_cancellation(parse_term("1"))
    feeder.add_fact(parse_atom("_seen(ball)"))
    second = goal("goal(c,d,2)")
    feeder.add_goal(second)
    feeder.add_executed([action("_action_lib(a,x,4)"), action("_action_lib(b,y,4)")])
    batch = feeder.next_update(5)
    assert batch.goals == (second,)
    assert words(str(batch.update)) == words("""
        #step 5.
        :- not _action_lib(a,x,4).  :- not _action_lib(b,y,4).
        _request(cancel(1),5).  _request(goal(c,d,2),6).
        _return(a,x,4).  _seen(ball).
        #end step.""")
    assert parse_update(str(batch.update)) == batch.update


def test_what_is_foreseen_is_what_comes_whichever_action_ends_first():
    feeder, done = InputFeeder(), [action("_action_lib(a,x,4)"), action("_action_lib(b,y,4)")]
    predicted = feeder.predicted(5, done, over=2)
    feeder.add_executed(done)
    for text in ("_return(b,y,4)", "_return(a,x,4)"):
        feeder.add_fact(parse_atom(text))
    assert feeder.next_update(5, over=2).update == predicted
    feeder.add_fact(parse_atom("_seen(ball)"))
    assert words(str(feeder.next_update(5).update))[-5:-2] == words("_return(a,x,4). _return(b,y,4). _seen(ball).")


def test_a_failure_stays_where_it_came():
    feeder = InputFeeder()
    feeder.add_executed([action("_action_lib(a,x,4)"), action("_action_lib(b,y,4)")])
    for text in ("_return(b,y,4)", "_seen(ball)", "_return(a,no,4)"):
        feeder.add_fact(parse_atom(text))
    assert words(str(feeder.next_update(5).update))[-5:-2] == words("_return(b,y,4). _seen(ball). _return(a,no,4).")


def test_goals_that_are_foreseen_come_as_they_would():
    feeder, new = InputFeeder(), goal("goal(c,d,2)")
    predicted = feeder.predicted(5, [action("_action_lib(a,x,4)")], [new])
    feeder.add_executed([action("_action_lib(a,x,4)")])
    feeder.add_fact(parse_atom("_return(a,x,4)"))
    assert feeder.next_update(5).update != predicted
    feeder.add_goal(new)
    assert feeder.next_update(5).update == predicted


def test_a_goal_waits_until_the_program_has_heard_that_an_earlier_one_of_its_identifier_is_given_up():
    feeder, again = InputFeeder(), goal("goal(c,d,1)")
    feeder.add_cancellation(parse_term("1"))
    feeder.add_goal(again)
    first = feeder.next_update(5)
    assert words(str(first.update)) == words("#step 5. _request(cancel(1),5). #end step.")
    feeder.taken(first)
    assert feeder.pending
    assert feeder.next_update(6).goals == (again,)


def test_the_feeder_is_empty_once_its_update_is_taken():
    feeder, first = InputFeeder(), goal("g(1)")
    feeder.add_goal(first)
    feeder.add_executed([action("_action_lib(a,x,4)")])
    feeder.add_fact(parse_atom("_seen(ball)"))
    assert feeder.pending
    batch = feeder.next_update(1)
    assert feeder.pending
    assert not first.fed
    feeder.taken(batch)
    assert not feeder.pending
    assert first.request_cycle == 2
    assert words(str(feeder.next_update(2).update)) == words("#step 2. #end step.")


def test_what_comes_while_an_update_is_made_waits_for_the_next_one():
    feeder = InputFeeder()
    feeder.add_cancellation(parse_term("7"))
    feeder.add_rejection(parse_term("7"))
    batch = feeder.next_update(1)
    assert heads(batch.update) == ["_request(cancel(7),1)"] * 2
    second = goal("g(2)")
    feeder.add_goal(second)
    feeder.add_cancellation(parse_term("8"))
    feeder.add_fact(parse_atom("_seen(ball)"))
    feeder.taken(batch)
    assert heads(feeder.next_update(2).update) == ["_request(g(2),3)", "_request(cancel(8),2)", "_seen(ball)"]


def test_a_rejected_goal_is_not_cancelled_once_another_of_its_identity_comes():
    feeder = InputFeeder()
    for identifier in ("1", "2"):
        feeder.add_rejection(parse_term(identifier))
    feeder.add_goal(goal("g(1)"))
    assert heads(feeder.next_update(3).update) == ["_request(cancel(2),3)", "_request(g(1),4)"]


def test_whether_more_comes_than_is_expected():
    feeder, seen = InputFeeder(), parse_atom("_return(go,a,1)")
    assert not feeder.has_beside(())
    feeder.add_fact(seen)
    assert feeder.has_beside(())
    assert not feeder.has_beside({seen})
    for add in (
        lambda one: one.add_rejection(parse_term("1")),
        lambda one: one.add_withdrawals(frozenset([parse_atom("_request(do(walk,1),1)")])),
        lambda one: one.add_fact(parse_atom("_seen(sun)")),
    ):
        other = InputFeeder()
        add(other)
        assert other.has_beside({seen})


def heads(update):
    return [str(item.head) for item in update.items if isinstance(item, Statement) and item.head is not None]


def test_what_was_not_taken_comes_with_the_next_update():
    feeder = InputFeeder(Clock())
    first, second = goal("g(1)"), goal("g(2)")
    feeder.add_goal(first)
    feeder.add_goal(second)
    feeder.add_cancellation(parse_term("7"))
    feeder.add_fact(parse_atom("_seen(ball,now)"))
    feeder.add_executed([action("_action_lib(a,x,2)")])
    batch = feeder.next_update(3)
    assert heads(batch.update) == ["_request(g(1),4)", "_request(g(2),4)", "_request(cancel(7),3)", "_seen(ball,3)"]
    first.end(Outcome.CANCELED, "is cancelled")
    feeder.add_fact(parse_atom("_seen(dog,now)"))
    assert feeder.pending
    feeder.withdraw(first)
    again = feeder.next_update(4)
    assert heads(again.update) == ["_request(g(2),5)", "_request(cancel(7),4)", "_seen(ball,4)", "_seen(dog,4)"]
    assert [str(one) for one in again.update.items if one.head is None] == [":- not _action_lib(a,x,2)."]
    feeder.taken(again)
    assert not feeder.pending


def test_facts_of_cycles_that_are_over_are_taken_for_the_present():
    feeder = InputFeeder(Clock(lambda name, arity: None if name == "_kind" else 1))
    for text in ("_seen(ball,2)", "_seen(dog,9)", "_seen(cat,now)", "_kind(2)", "_return(a,x,2)"):
        feeder.add_fact(parse_atom(text), "eye", 10)
    batch = feeder.next_update(10, over=9)
    assert str(batch.update.items[0]) == "#over 9."
    assert heads(batch.update) == ["_seen(ball,9)", "_seen(dog,9)", "_seen(cat,9)", "_kind(2)", "_return(a,x,2)"]
    assert [str(one.sent) for one in batch.facts if one.outdated] == ["_seen(ball,2)"]
    assert {(one.origin, one.cycle) for one in batch.facts} == {("eye", 10)}
    assert heads(feeder.next_update(10, over=1).update) == heads(feeder.next_update(10).update)
    assert [str(feeder.next_update(10, over).update.items[0]) for over in (0, 1)] == ["_seen(ball,2).", "#over 1."]


def test_a_preview_takes_nothing():
    feeder = InputFeeder()
    feeder.add_fact(parse_atom("_seen(ball)"))
    further = [parse_atom("_seen(dog)"), parse_atom("_seen(ball)")]
    assert heads(feeder.preview(2, [], further)) == ["_seen(ball)", "_seen(dog)"]
    assert heads(feeder.next_update(2).update) == ["_seen(ball)"]


def test_cycles_of_facts():
    clock = Clock(lambda name, arity: {"_late": 1, "_seen": 0}.get(name), first=1)
    atoms = {
        text: parse_atom(text) for text in ("_seen(now)", "_late(x,now)", "_seen(3)", "_kind(3)", "_seen", "_late(a)")
    }
    assert str(clock.dated(atoms["_seen(now)"], 5)) == "_seen(5)"
    assert str(clock.dated(atoms["_late(x,now)"], 5)) == "_late(x,4)"
    assert str(clock.dated(atoms["_late(x,now)"], 1)) == "_late(x,1)"
    assert clock.dated(atoms["_seen(3)"], 5) == atoms["_seen(3)"]
    assert [clock.cycle_of(atom) for atom in atoms.values()] == [None, None, 3, None, None, None]
    assert [clock.is_too_early(atoms["_late(x,now)"], step) for step in (1, 2)] == [True, False]
    assert not clock.is_too_early(atoms["_seen(now)"], 1)
    assert not clock.is_too_early(atoms["_late(a)"], 1)
    assert str(clock.at_present(parse_atom("-_seen(a,1)"), 5)) == "-_seen(a,5)"


def test_what_has_arrived_is_counted():
    feeder = InputFeeder()
    assert (feeder.arrivals, feeder.waiting, feeder.pending) == (0, 0, False)
    feeder.add_fact(parse_atom("_seen(ball)"))
    assert (feeder.arrivals, feeder.waiting, feeder.pending) == (1, 1, True)
    feeder.add_goal(goal("g(1)"))
    feeder.add_cancellation(parse_term("7"))
    assert (feeder.arrivals, feeder.waiting) == (3, 1)


@pytest.mark.parametrize("more", ["goal", "cancellation", "fact"])
def test_whatever_arrives_ends_the_wait(more):
    feeder = InputFeeder()
    feeder.add_fact(parse_atom("_seen(ball)"))
    feeder.wait()
    assert not feeder.pending
    if more == "goal":
        feeder.add_goal(goal("g(1)"))
    elif more == "cancellation":
        feeder.add_cancellation(parse_term("7"))
    else:
        feeder.add_fact(parse_atom("_seen(ball)"))
    assert feeder.pending


def test_an_update_that_waits_is_made_with_whatever_comes_and_after_it_nothing_waits():
    feeder = InputFeeder(Clock(lambda name, arity: 1))
    feeder.add_goal(goal("g(1)"))
    feeder.add_fact(parse_atom("_shut(den,now)"))
    feeder.wait()
    feeder.taken(feeder.next_update(1))
    assert feeder.pending, "the goal"


def test_what_was_not_taken_comes_first_and_as_it_was_told():
    feeder = InputFeeder(Clock())
    first, second = goal("g(1)"), goal("g(2)")
    feeder.add_goal(first)
    feeder.add_fact(parse_atom("_seen(ball,now)"))
    feeder.next_update(3)
    feeder.add_goal(second)
    feeder.add_cancellation(parse_term("7"))
    feeder.add_fact(parse_atom("_seen(ball,now)"))
    assert not first.fed
    assert feeder.waiting == 1, "the same was told twice"
    assert heads(feeder.next_update(4).update) == [
        *("_request(g(1),5)", "_request(g(2),5)", "_request(cancel(7),4)", "_seen(ball,4)"),
    ]


def test_goals_wait_for_a_fact_of_now_that_takes_effect_with_the_next_update_only():
    feeder = InputFeeder(Clock(lambda name, arity: 1))
    waits = goal("g(1)")
    feeder.add_goal(waits)
    feeder.add_cancellation(parse_term("7"))
    feeder.add_fact(parse_atom("_shut(den,now)"))
    batch = feeder.next_update(1)
    assert batch.goals == ()
    assert heads(batch.update) == ["_request(cancel(7),1)", "_shut(den,1)"]
    feeder.taken(batch)
    assert feeder.pending, "a goal waits"
    assert heads(feeder.next_update(2).update) == ["_request(g(1),3)"]


def test_facts_of_the_first_cycles_are_not_over():
    feeder = InputFeeder()
    feeder.add_fact(parse_atom("_seen(ball,0)"))
    assert feeder.next_update(1).facts[0].cycle == 0
    assert heads(feeder.preview(1, [])) == ["_seen(ball,0)"]
    assert heads(feeder.next_update(1).update) == ["_seen(ball,0)"]


def test_parts_of_an_update_that_says_more_than_statements():
    fed, unfed = goal("g(1)"), goal("g(2)")
    fed.feed(6)
    update = parse_update("#step 5. #withdraw _seen(a). :- not _action_lib(a,x,4). _request(g(1),6). #endstep.")
    batch = Batch(update, (fed, unfed))
    assert words(str(batch.indispensable)) == words(
        "#step 5. #withdraw _seen(a). :- not _action_lib(a,x,4). #end step."
    )
    assert words(str(batch.without_goals)) == words(
        "#step 5. #withdraw _seen(a). :- not _action_lib(a,x,4). #end step."
    )
    assert requests_of([fed, unfed]) == {parse_atom("_request(g(1),6)")}


def test_clocks():
    early = parse_atom("_late(x,now)")
    assert str(Clock(lambda name, arity: 9).dated(early, 3)) == "_late(x,1)", "the first cycle is 1"
    assert str(Clock(lambda name, arity: None).dated(early, 3)) == "_late(x,3)"
    assert Clock().dated(parse_atom("_rain"), 3) == parse_atom("_rain")


def test_what_waits_goes_on_in_another_feeder():
    feeder, first, gone = InputFeeder(), goal("g(1)"), goal("g(2)")
    feeder.add_goal(first)
    feeder.add_cancellation(parse_term("f(7)"))
    feeder.add_goal(gone)
    feeder.add_rejection(parse_term("8"))
    for name in ("_seen(ball)", "_battery(low,2)", "_seen(b)", "_seen(a)"):
        feeder.add_fact(parse_atom(name), "camera", 3)
    feeder.add_executed([action("_action_lib(a,x,4)"), action("_action_lib(b,y,4)")])
    withdrawn = frozenset(parse_atom(f"_request(g({number}),2)") for number in range(20, 40))
    feeder.add_withdrawals(withdrawn)
    feeder.wait(5.0)
    record = json.loads(json.dumps(feeder.record()))
    assert record["feeder"]["withdrawn"] == ",".join(map(str, sorted(withdrawn))), "whatever the set's order"
    twin = InputFeeder()
    twin.restore(record, {first.key: first}.get)
    assert (twin.arrivals, twin.pending, twin.waiting) == (7, False, 4)
    twin.tick(14.9)
    assert not twin.pending
    twin.tick(15.0)
    assert twin.pending
    feeder.withdraw(gone)
    assert twin.next_update(5) == feeder.next_update(5)
    assert twin.next_update(5).facts[0].origin == "camera"
    assert {**twin.record(), "feeder": None} == {**feeder.record(), "feeder": None}
    assert str(twin.next_update(5).update).startswith(
        "#step 5.\n#withdraw _request(g(20),2).\n#withdraw _request(g(21),2)."
    )


def test_an_update_without_a_step_is_of_the_first_cycle():
    assert Batch(StreamUpdate(None, None, ())).request_cycle == 1
