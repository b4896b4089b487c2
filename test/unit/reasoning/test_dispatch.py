"""Returns of the actions of one cycle: the action of each return, missing returns, and failures."""

import pytest
from core_scripts import perform, scripts

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import TIMEOUT, action_of, return_of
from rosoclingo.reasoning.returns import Dispatch, ReturnError


class Actions:
    """Actions of cycle 1, as INTERFACE,PARAMETER, and their returns: the words of scripts."""

    def __init__(self, actions):
        parsed = (action_of(parse_atom(f"_action_lib({one},1)")) for one in actions.split())
        self.dispatch = Dispatch(1, tuple(parsed), 0.0)

    def back(self, *values):
        """Return actions, as INTERFACE,VALUE."""
        for value in values:
            assert self.dispatch.missing
            self.dispatch.take(return_of(parse_atom(f"_return({value},1)")))

    def stray(self, value, *reason):
        """Expect a return to be refused for a reason."""
        with pytest.raises(ReturnError, match=" ".join(reason)):
            self.dispatch.take(return_of(parse_atom(f"_return({value},1)")))

    def expire(self, *expected):
        """Let all actions time out; expect these actions with their values, as PARAMETER:VALUE."""
        missing = self.dispatch.missing
        answers = self.dispatch.fail(missing, TIMEOUT)
        found = [f"{one.parameter}:{answer.value}" for one, answer in zip(missing, answers)]
        assert found == list(expected)

    def missing(self, *expected):
        assert [f"{one.interface},{one.parameter}" for one in self.dispatch.missing] == list(expected)

    def failures(self, *expected):
        """Expect these failures, each with its candidate actions, as INTERFACE,VALUE:ACTION:ACTION."""
        found = [
            ":".join([f"{answer.interface},{answer.value}", *(str(one.parameter) for one in actions)])
            for answer, actions in self.dispatch.failures(self.dispatch.returns)
        ]
        assert found == list(expected)


#: The actions, and the events.
RETURNS = {
    "twice the same": ("drive,a drive,b", "back drive,a; stray drive,a returned already; missing drive,b"),
    "failure that names no action": ("drive,a drive,b", """
        back drive,(f,c); failures drive,(f,c):a:b; back drive,failed; missing"""),
    "failures that name their actions": ("drive,a drive,b arm,c", """
        back drive,blocked(hard,b); missing drive,a arm,c; stray drive,b returned already
        back drive,a arm,failed(hard,c); missing; failures drive,blocked(hard,b):b arm,failed(hard,c):c"""),
    "failure is about any action that no other return names": ("drive,a drive,b drive,c", """
        back drive,failed; failures drive,failed:a:b:c; back drive,b drive,failed(c); missing
        failures drive,failed(c):c drive,failed:a"""),
    "time-outs of a place named timeout": ("drive,timeout drive,a drive,b arm,c", """
        back drive,a; expire timeout:failed(timeout) b:failed(timeout,b) c:timeout; missing
        failures drive,failed(timeout):timeout drive,failed(timeout,b):b arm,timeout:c"""),
    "time-outs of several actions name none of them": ("drive,a drive,b", """
        expire a:timeout b:timeout; failures drive,timeout:a:b drive,timeout:a:b"""),
}  # fmt: skip


@scripts(RETURNS)
def test_dispatch_matches_returns_with_actions(row):
    actions, script = row
    perform(Actions(actions), script)
