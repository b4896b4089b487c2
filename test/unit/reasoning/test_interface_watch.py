"""Interfaces that fall silent: lost robots, their actions, and robots that are back."""

import pytest
from core_driver import Driver
from core_scripts import play, scripts
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, parse_atom, parse_term
from rosoclingo.reasoning.events import ActionsPreempted, Announcer
from rosoclingo.reasoning.interface_watch import InterfaceWatch
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.settings import CoreSettings

#: Goals ``do(Id)``, each executed by one of two robots that is not lost.
ROBOTS = """
robot(r1;r2).
#external _request/2. #external _return/3. #external _lost/2. #external _back/2.
#program cumulative(t).
lost(R,t) :- _lost(R,t).
lost(R,t) :- lost(R,t-1), not _back(R,t).
open(I,t) :- _request(do(I),t).
open(I,t) :- open(I,t-1), not done(I,t-1).
{ _action_lib(work(R),I,t) : robot(R), open(I,t), not lost(R,t) }.
:- _action_lib(work(R),I,t), _action_lib(work(R),J,t), I < J.
:- _action_lib(work(r1),I,t), _action_lib(work(r2),I,t).
failed(I,t) :- _action_lib(work(R),I,t), _return(work(R),V,t), V != I.
done(I,t) :- _action_lib(work(R),I,t), not failed(I,t).
#program volatile(t).
:- open(I,t), not done(I,t).
#program base.
#show _action_lib/3.
"""

SETTINGS = CoreSettings(horizon_limit=8, interface_timeout=10.0, lost_timeout=60.0)


class WatchedDriver(Driver):
    """A driver whose wall time passes, with the words ``announce`` and ``silence``."""

    wall = 100.0

    def announce(self, *interfaces):
        for one in interfaces:
            self.core.interfaces.announce(one)
        self.run()

    def silence(self, seconds, *others):
        """Let time pass, in which only the ``others`` announce themselves."""
        for _ in range(2 * int(seconds)):
            self.wall += 0.5
            self.core.interfaces.look(self.wall)
            for one in others:
                self.core.interfaces.announce(one)
            self.core.advance(self.now)
        self.core.interfaces.look(self.wall)
        self.run()

    def suspend(self, seconds):
        """Let time pass in which the core does nothing."""
        self.wall += float(seconds)
        self.core.interfaces.look(self.wall)
        self.run()


#: The program's changes, and the script. Two goals always occupy both robots.
SILENCES = {
    "lost and back": ("", """
        silence 0; announce work(r1) work(r2); silence 9 work(r2); problems 0; silence 1 work(r2)
        problem _lost(r1,now): work(r1) has been silent for 10 s; sends _lost(r1,1).
        goal a do(1); does work(r2),1,3; silence 100 work(r2); problems 1
        announce work(r1); problem _back(r1,now): work(r1) is heard again; succeed; sends ..._back(r1,...).
        is a succeeded; goal b do(3); goal c do(4); problems 2"""),
    "return of a lost robot": ("", """
        silence 0; announce work(r1) work(r2); add a do(1); goal b do(2); does work(r1),2,2 work(r2),1,2
        silence 30 work(r2); announce work(r1); finish; sent ..._lost(r1,...; unsent ...lost,...)...
        is a succeeded; is b succeeded"""),
    "robot that never returns": ("", """
        silence 0; announce work(r1) work(r2); add a do(1); goal b do(2); does work(r1),2,2 work(r2),1,2
        silence 69 work(r2); problems 1; facts _return(work(r2),1,2)
        silence 1 work(r2); problem _action_lib(work(r1),2,2) has no return, and its interface is lost: it ...
        sent ..._return(work(r1),lost,2)...; does work(r2),...,...; finish; is a succeeded; is b succeeded; ends
        announce work(r1); ends work(r1),2,2"""),
    "program that declares nothing": (("_lost/2. #external", "_lost/1. #external"), """
        silence 0; announce work(r1) work(r2); add a do(1); goal b do(2); silence 100; problems 0; finish
        is a succeeded"""),
    "core that was suspended": ("", """
        silence 0; announce work(r1); suspend 1000; suspend 1000; problems 0; silence 8; problem _lost(r1,...)..."""),
}  # fmt: skip


@scripts(SILENCES)
def test_watch_reports_silent_interfaces_to_program(row):
    change, script = row
    play(WatchedDriver(ROBOTS.replace(*change) if change else ROBOTS, SETTINGS), script)


class Execution:
    """Running actions, and what the program has received."""

    def __init__(self, actions):
        self.awaited = tuple(action_of(parse_atom(f"_action_lib({one},3)")) for one in actions)
        self.facts, self.failed = [], []

    def receive(self, origin, facts):
        assert [str(parse_atom(one).arguments[0]) for one in facts] == [origin]
        self.facts += facts

    def fail(self, actions, reason, why):
        assert (reason, why) == (parse_term("lost"), "has no return, and its interface is lost")
        self.failed += actions
        self.awaited = tuple(one for one in self.awaited if one not in actions)


NAMES = ("work(r1)", "arm(r1)", "work(r2)")
STEPS = st.lists(
    st.one_of(
        st.sampled_from(NAMES).map(lambda one: ("announce", one)),
        st.sampled_from((0.25, 0.5, 1.0, 1.0, 5.0)).map(lambda one: ("look", one)),
        st.just(("resume", "")),
    ),
    max_size=60,
)


@pytest.mark.slow
@given(STEPS, st.sampled_from((2.0, 3.5)), st.sampled_from((0.0, 2.0)))
def test_watch_agrees_with_simple_model_across_restarts(steps, timeout, lost_timeout):
    program, execution, events = ReactiveProgram.from_text(ROBOTS), Execution(["work(r1),1", "work(r2),1"]), []

    def start():
        announce = Announcer(events.append, lambda: 3, program.time_position)
        return InterfaceWatch(program, execution, announce, timeout, lost_timeout)

    watch, wall, time, silent, expected = start(), 50.0, 0.0, {}, []
    heard = {one.interface_name: time for one in execution.awaited}
    watch.look(wall)
    for verb, value in steps:
        lost = {one[-3:-1] for one in silent}
        if verb == "announce":
            watch.announce(value)
            heard[value] = time
            silent.pop(value, None)
        elif verb == "look":
            wall, time = wall + value, time + min(value, 1.0)
            watch.look(wall)
            heard = {**{one.interface_name: time for one in execution.awaited}, **heard}
            silent.update({name: time for name, at in heard.items() if time - at >= timeout and name not in silent})
        else:
            record, watch = watch.record(), start()
            watch.restore(record)
            watch.look(wall)
            heard, silent = dict.fromkeys(heard, time), dict.fromkeys(silent, time)
        after = {one[-3:-1] for one in silent}
        expected += [f"_lost({one},now)" for one in sorted(after - lost)]
        expected += [f"_back({one},now)" for one in sorted(lost - after)]
        assert sorted(execution.facts) == sorted(expected)
        assert sorted(map(str, watch.lost)) == sorted(after)
        assert len(set(execution.failed)) == len(execution.failed), "an action fails once"
        open_ = {one.interface_name for one in execution.awaited}
        late = {name for name, since in silent.items() if 0 < lost_timeout <= time - since}
        assert verb != "look" or not open_ & late, "an action of a lost interface fails in time"
        ended = [one for event in events if isinstance(event, ActionsPreempted) for one in event.actions]
        assert len(set(ended)) == len(ended)
        uncancelled = {one.interface_name for one in execution.failed if one not in ended}
        assert uncancelled <= set(silent), "actions that failed are cancelled once their interface is heard again"
