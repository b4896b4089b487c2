"""Kill the core and the interfaces at any instant, alone or together: no action runs twice, each goal ends once.

Also while actions of several cycles run, and with preemption. The action servers survive every kill.
"""

from collections import Counter

import office_world
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from killed_core import HAPPENED, KEYS, KILLS, World, played
from shipped import shipped
from team_programs import TEAM

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.goals import GoalState

#: Goals do(Machine,Id) as those of the errands, any number of them at once.
ERRANDS_AT_ONCE = TEAM.replace("job(M,I)", "do(M,I)").replace("M != broken", "M != never")


class Team(World):
    """A world in which several errands run at once, and go on from cycle to cycle."""

    program = ReactiveProgram.from_text(ERRANDS_AT_ONCE)


class Mailbot(World):
    """The interfaces of the mailbot: kinds of goals are pairs of offices, and the key is the package.

    The world is modelled independently of the program. Failures are too rare to abort a goal.
    """

    horizon_limit = 30

    def __init__(self, folder, fate):
        super().__init__(folder, fate)
        self._office, self._failures = office_world.World(), Counter()

    @property
    def program(self):
        """Return the program of the core."""
        return shipped("mailbot.lp", "office.lp")

    @staticmethod
    def text(key, kind):
        """Return the text of a goal."""
        return "goal({},{},{})".format(*kind, key)

    def execute(self, action, good):
        """Execute a possible action of the robot, or fail."""
        for key, (origin, _) in self.goals.items():
            self._office.places.setdefault(key, origin)
        self._failures[str(action.parameter)] += not good
        if not good and self._failures[str(action.parameter)] < 3:
            return "failed"
        self._office.do(action)
        return action.parameter

    def check(self):
        """Check that each goal has ended and that its package is where the end says."""
        for key, (origin, target) in self.goals.items():
            place = self._office.places.get(key, origin)
            if self.ends[key] is GoalState.SUCCEEDED:
                assert place == target
            else:
                assert self.ends[key] in (GoalState.RECALLED, GoalState.PREEMPTED)
                assert key in self.cancelled
                assert place in (origin, target)  # present if the goal was cancelled during the delivery


#: Goals that are met, rejected, cancelled and aborted, a failure, a fact, concurrent and consecutive goals.
SCRIPT = [
    ("goal", "walk"),
    ("goal", "quick"),
    ("goal", "nonsense"),
    ("answer", 0, False),
    ("goal", "run"),
    ("cancel", 4),
    ("fact", "_seen(ball)"),
    ("answer", 1, True),
    ("goal", "never"),
    ("answer", 0, True),
    ("goal", "walk"),
    ("cancel", 6),
    ("goal", "run"),
    ("answer", 0, False),
]


#: Errands that start and end in several cycles, failures with and without others under way, a cancel, an abort.
TEAM_SCRIPT = [
    ("goal", "walk"),
    ("goal", "run"),
    ("answer", 0, False),
    ("goal", "quick"),
    ("goal", "walk"),
    ("answer", 1, True),
    ("goal", "never"),
    ("fact", "_seen(ball)"),
    ("cancel", 4),
    ("answer", 2, False),
    ("answer", 0, True),
]


@pytest.mark.slow
@pytest.mark.parametrize(("script", "kind"), [(SCRIPT, World), (TEAM_SCRIPT, Team)], ids=["errands", "team"])
def test_interfaces_or_core_survive_kill_at_every_instant(script, kind):
    play, fate = played(script, kind=kind)
    assert (play.kills, play.world.kills, bool(fate.writes)) == (0, 0, True)
    interfaces = 0
    for instant, share in fate.kills_at_every_instant():
        play, _ = played(script, [(instant, share, False)], kind)
        assert play.kills + play.world.kills == 1
        interfaces += play.world.kills
    assert 0 < interfaces < fate.instants


@pytest.mark.slow
@given(script=st.lists(HAPPENED, min_size=3, max_size=14), kills=KILLS, long_actions=st.booleans())
def test_interfaces_and_core_survive_repeated_kills(script, kills, long_actions):
    played(script, kills, Team if long_actions else World, preempt=not long_actions)


PAIRS = st.permutations(office_world.OFFICES).map(lambda offices: tuple(offices[:2]))
ORDERED = st.one_of(
    st.tuples(st.just("goal"), PAIRS),
    st.tuples(st.just("cancel"), KEYS),
    *[st.tuples(st.just("answer"), KEYS, st.booleans())] * 3,
)


@pytest.mark.slow
@settings(max_examples=max(3, settings.default.max_examples // 8))
@given(script=st.lists(ORDERED, min_size=5, max_size=20), kills=KILLS)
def test_mailbot_packages_end_in_right_place_after_kills(script, kills):
    played(script, kills, Mailbot)
