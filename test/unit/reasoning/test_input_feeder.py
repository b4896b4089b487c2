"""The input feeder: arrivals become the next update in order; queued ones move to another feeder."""

from core_scripts import perform, scripts

from rosoclingo.oclingo import parse_atom, parse_term, parse_update
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.input_feeder import Clock, InputFeeder
from rosoclingo.reasoning.keywords import action_of


def goal(text):
    return Goal(text, parse_term(text))


def action(text):
    return action_of(parse_atom(f"_action_lib({text})"))


def body(update):
    """Return an update in one line without its frame."""
    return " ".join(str(update).split()[2:-2])


class Feeder(InputFeeder):
    """The words of scripts."""

    def __init__(self, clock=None):
        super().__init__(*([] if clock is None else [clock]))
        self.goals, self.batch, self.update = {}, None, None

    def facts(self, *texts):
        for text in texts:
            self.add_fact(parse_atom(text), "eye", 3)

    def done(self, *texts):
        self.add_executed([*map(action, texts)])

    def goal(self, text):
        self.goals[text] = goal(text)
        self.add_goal(self.goals[text])

    def cancel(self, identifier):
        self.add_cancellation(parse_term(identifier))

    def reject(self, identifier):
        self.add_rejection(parse_term(identifier))

    def next(self, step, *words):
        """Expect the update of a step."""
        self.batch = self.next_update(int(step))
        assert body(self.batch.update) == " ".join(words)
        assert parse_update(str(self.batch.update)) == self.batch.update

    def take(self):
        """Accept the update of the last expectation."""
        self.update_accepted(self.batch)

    def ends(self, text):
        """End a goal before it was fed."""
        self.goals[text].end(Outcome.CANCELED, "is cancelled")
        self.withdraw(self.goals[text])

    def is_pending(self, truth, waiting=None):
        """Expect ``yes`` or ``no`` for a pending update, and the number of queued facts."""
        assert self.pending == (truth == "yes")
        assert waiting is None or self.waiting == int(waiting)


#: The clock, and the script.
UPDATES = {
    "commitments, requests, facts": (None, """
        facts _return(b,y,4); cancel 1; facts _seen(ball) _return(a,x,4); goal goal(c,d,2); done a,x,4 b,y,4
        next 5 :- not _action_lib(a,x,4). :- not _action_lib(b,y,4). _request(cancel(1),5). _request(goal(c,d,2),6). """
        "_return(a,x,4). _seen(ball). _return(b,y,4)."),
    "failure stays where it came": (None, """
        done a,x,4 b,y,4; facts _return(b,y,4) _seen(ball) _return(a,no,4)
        next 5 :- not _action_lib(a,x,4). :- not _action_lib(b,y,4). _return(b,y,4). _seen(ball). _return(a,no,4)."""),
    "goal waits until the cancel of its identity is known": (None, """
        cancel 1; goal goal(c,d,1); next 5 _request(cancel(1),5).; take; is_pending yes
        next 6 _request(goal(c,d,1),7)."""),
    "rejected goal is not cancelled once another of its identity comes": (None, """
        reject 1; reject 2; goal g(1); next 3 _request(cancel(2),3). _request(g(1),4)."""),
    "update that was not accepted comes with the next one": (Clock(), """
        goal g(1); goal g(2); cancel 7; facts _seen(ball,now); done a,x,2
        next 3 :- not _action_lib(a,x,2). _request(g(1),4). _request(g(2),4). _request(cancel(7),3). _seen(ball,3).
        ends g(1); facts _seen(dog,now); is_pending yes
        next 4 :- not _action_lib(a,x,2). _request(g(2),5). _request(cancel(7),4). _seen(ball,4). _seen(dog,4).
        take; is_pending no"""),
    "facts of the first cycles are not over": (None, "facts _seen(ball,0); next 1 _seen(ball,0)."),
    **{f"{arrival} ends the wait": (None, f"facts _seen(ball); wait; is_pending no; {arrival}; is_pending yes")
       for arrival in ("goal g(1)", "cancel 7", "facts _seen(ball)")},
}  # fmt: skip


@scripts(UPDATES)
def test_feeder_makes_the_expected_update(row):
    clock, script = row
    perform(Feeder(clock), script)


def test_feeder_dates_a_goal_with_its_request():
    feeder = perform(Feeder(), "goal g(1); next 1 _request(g(1),2).")
    first = feeder.goals["g(1)"]
    assert feeder.batch.goals == [first]
    assert not first.fed
    feeder.take()
    assert first.request_cycle == 2


def test_feeder_assigns_cycles_to_facts():
    clock = Clock(lambda name, arity: {"_late": 1, "_seen": 0}.get(name), first=1)
    late, seen = parse_atom("_late(x,now)"), parse_atom("_seen(now)")
    assert [str(clock.dated(seen, 5)), str(clock.dated(late, 5)), str(clock.dated(late, 1))] == [
        *("_seen(5)", "_late(x,4)", "_late(x,1)"),
    ]
    assert clock.dated(parse_atom("_seen(3)"), 5) == parse_atom("_seen(3)")
    texts = ("_seen(now)", "_late(x,now)", "_seen(3)", "_kind(3)", "_seen", "_late(a)")
    assert [clock.cycle_of(parse_atom(text)) for text in texts] == [None, None, 3, None, None, None]
    assert [clock.is_too_early(late, step) for step in (1, 2)] == [True, False]
    assert not clock.is_too_early(seen, 1)
    assert not clock.is_too_early(parse_atom("_late(a)"), 1)
    assert str(clock.at_present(parse_atom("-_seen(a,1)"), 5)) == "-_seen(a,5)"
    assert str(Clock(lambda name, arity: 9).dated(late, 3)) == "_late(x,1)", "the first cycle is 1"
    assert str(Clock(lambda name, arity: None).dated(late, 3)) == "_late(x,3)"
    assert Clock().dated(parse_atom("_rain"), 3) == parse_atom("_rain")
