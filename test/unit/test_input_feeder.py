from rosoclingo.oclingo import parse_atom, parse_term, parse_update
from rosoclingo.reasoning import Goal
from rosoclingo.reasoning.input_feeder import InputFeeder
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
    batch = feeder.next_update(5, [action("_action_lib(a,x,4)"), action("_action_lib(b,y,4)")])
    assert batch.goals == (second,)
    assert words(str(batch.update)) == words("""
        #step 5.
        :- not _action_lib(a,x,4).  :- not _action_lib(b,y,4).
        _request(cancel(1),5).  _request(goal(c,d,2),6).
        _return(a,x,4).  _seen(ball).
        #end step.""")
    assert parse_update(str(batch.update)) == batch.update


def test_feeder_is_empty_afterwards():
    feeder = InputFeeder()
    feeder.add_goal(goal("g(1)"))
    assert feeder.pending
    feeder.next_update(1, [])
    assert not feeder.pending
    assert words(str(feeder.next_update(2, []).update)) == words("#step 2. #end step.")


def test_withdrawn_goal_is_not_fed():
    feeder = InputFeeder()
    first, second = goal("g(1)"), goal("g(2)")
    feeder.add_goal(first)
    feeder.add_goal(second)
    feeder.withdraw(first)
    assert feeder.next_update(1, []).goals == (second,)


def test_same_fact_twice_is_one():
    feeder = InputFeeder()
    feeder.add_fact(parse_atom("_seen(ball)"))
    feeder.add_fact(parse_atom("_seen(ball)"))
    assert len(feeder.next_update(1, []).update.items) == 1
