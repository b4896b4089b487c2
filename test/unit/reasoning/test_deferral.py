"""Which goals are withdrawn from the program, with a planner that only knows goals in hand and slow searches."""

from types import SimpleNamespace

import pytest
from clingo import parse_term
from goal_clients import Clients, numbers, numbers_of

from rosoclingo.oclingo import SolveOutcome, SolverError, SolveResult, Statement
from rosoclingo.oclingo.progression.updates import Withdraw
from rosoclingo.reasoning.deferral import defer
from rosoclingo.reasoning.keywords import action_of, success_of

#: The cycle of the last update, the horizon bound, and the bound once all goals are cancelled.
STEP, STEPS, LEAST = 7, 20, 5

WHY = "it took too long"

#: The last action, after which only the new goals arrived.
LAST = action_of(parse_term(f"_action_lib(walk,far,{STEP - 1})"))


class World:
    """A planner for goals 1 to ``goals``, of which ``fresh`` are new with the last update, and their manager.

    Withdrawing ``bound`` goals ("1" or "2 3") together makes the plan longer. The solver refuses the update if one of
    the sets ``refused`` is withdrawn; ``over`` arrives too late.
    """

    def __init__(self, goals, fresh="", bound=(), **others):
        self.clients = Clients().add(*range(1, goals + 1))
        self.fresh = [self.clients.goal(int(number)) for number in fresh.split()]
        self.clients.feed(STEP - 3)
        for goal in self.fresh:
            goal.feed(STEP + 1)
        self.bound = [set(one.split()) for one in bound]
        self.refused = [set(one.split()) for one in others.pop("refused", ())]
        self.outcome = others.pop("outcome", SolveOutcome.UNSATISFIABLE)
        self.least = others.pop("least", LEAST)
        self.log, self.lookahead = SimpleNamespace(step=STEP, keep_from=others.pop("over", 0)), STEPS
        assert not others
        self.planners, self.updates, self.bounds = [], [], []

    def restarted(self, without):
        self.planners.append(TrialPlanner(self, without))
        return self.planners[-1]

    def put_off(self, *chosen, last_update=STEP):
        """Withdraw the chosen goals or others; return the planner that continues, and the outcome."""
        goals = [self.clients.goal(number) for number in chosen]
        return defer(self, self.clients.goals, goals, WHY, last_update, [LAST], lambda: None)

    @property
    def questions(self):
        return [" ".join(map(str, update.items)) for update in self.updates]


class TrialPlanner:
    """A trial planner derived from that of the world, which never received some of the requests."""

    def __init__(self, world, without):
        self.world, self.without, self.lookahead = world, without, STEPS

    def update(self, update):
        withdrawn = {item.atom for item in update.items if isinstance(item, Withdraw)}
        assert withdrawn == self.without - {success_of(LAST)}, "the trial does without the returns"
        assert success_of(LAST) in self.without
        assert [item for item in update.items if isinstance(item, Withdraw)] == [*map(Withdraw, sorted(withdrawn))]
        assert update.step == STEP + 1
        world, gone = self.world, {str(one.arguments[0].arguments[0]) for one in withdrawn}
        cancelled = {str(one.head.arguments[0].arguments[0]) for one in update.items if isinstance(one, Statement)}
        assert gone | cancelled == {goal.key[1:] for goal in world.clients.goals.fed}
        assert not gone & cancelled
        world.updates.append(update)
        world.bounds.append(self.lookahead)
        if gone in world.refused:
            raise SolverError("refused by the test")
        steps = world.least + any(one <= gone for one in world.bound)
        outcome = SolveOutcome.SATISFIABLE if steps <= self.lookahead else world.outcome
        return SolveResult(outcome, (), update.step + steps, update.step)


def requests(*terms):
    return frozenset(map(parse_term, terms))


def test_deferral_queues_goals_without_any_action():
    world = World(4)
    planner, message = world.put_off(3, 4)
    assert message == "it took too long: 2 of 4 goals wait"
    assert (world.clients.served, world.clients.waiting) == ([1, 2], [3, 4])
    assert world.clients.waits(4) == ["4 goals were too many: it took too long"]
    assert planner is world.planners[-1]
    assert planner.without == requests("_request(go(3),5)", "_request(go(4),5)")
    assert world.questions == [
        " ".join(f"_request(cancel({number}),8)." for number in (1, 2, 3, 4)),
        "#withdraw _request(go(3),5). #withdraw _request(go(4),5). _request(cancel(1),8). _request(cancel(2),8).",
    ]
    assert world.bounds == [STEPS, LEAST], "without them a plan is as short as where all is cancelled"
    assert world.clients.feed(STEP + 1)[:2] == ["#withdraw _request(go(3),5)", "#withdraw _request(go(4),5)"]


def test_deferral_queues_new_goals_without_a_question():
    world = World(4, fresh="3 4")
    planner, _ = world.put_off(3, 4)
    assert world.clients.waiting == [3, 4]
    assert (planner.without, world.updates) == (requests("_request(go(3),8)", "_request(go(4),8)"), [])
    world = World(4, fresh="3 4")
    world.put_off(3, 4, last_update=STEP - 1)
    assert world.clients.feed(STEP + 1) == [], "an update with their requests was never sent"


def test_deferral_leaves_new_goals_out_of_questions():
    world = World(5, fresh="2 5")
    world.put_off(4, 5)
    assert world.clients.waiting == [4, 5]
    assert world.questions[0].startswith("#withdraw _request(go(2),8). #withdraw _request(go(5),8). _request(cancel(1)")
    assert world.questions[1].startswith("#withdraw _request(go(2),8). #withdraw _request(go(4),5). #withdraw")


HAND = [
    (["3"], "4-6"),
    (["4", "6"], "3 5"),
    (["3 4"], "3 5 6"),
    (["3 5", "4 6"], "3 4"),
    (["3", "4", "5 6"], "5"),
    (["3", "4", "5"], "6"),
    (["1", "2"], "3-6"),
    ([], "3-6"),
]
UNKNOWN = [
    {"outcome": outcome, **why}
    for outcome in (SolveOutcome.UNSATISFIABLE, SolveOutcome.INTERRUPTED)
    for why in ({"refused": ["", "3"]}, {"least": STEPS + 1})
]


@pytest.mark.parametrize(
    ("world", "chosen", "waiting"),
    [
        *((World(6, bound=bound), "3-6", waiting) for bound, waiting in HAND),
        *((World(2, over=over), "2", waiting) for over, waiting in ((4, "2"), (5, ""))),  # past goals stay
        (World(4, refused=["3 4", "3"]), "3 4", "4"),  # refused or too long: in hand
        (World(4, bound=["3"], outcome=SolveOutcome.INTERRUPTED), "3 4", "4"),
        *((World(2, **others), "2", "") for others in UNKNOWN),  # an older goal stays, and so does the other
        *((World(3, fresh="3", **others), "2 3", "3") for others in UNKNOWN),
    ],
)
def test_deferral_leaves_goals_in_hand_alone(world, chosen, waiting):
    total = len(world.clients.live)
    _, message = world.put_off(*numbers_of(chosen.split()))
    assert world.clients.waiting == numbers_of(waiting.split())
    number = len(world.clients.waiting)
    assert message == "it took too long: " + (f"{number} of {total} goals wait" if number else "the search goes on")
    assert waiting or total > 2 or len(world.updates) <= 2


def test_deferral_queues_the_others_if_all_are_in_hand():
    world = World(5, bound=["4", "5", "2"])
    world.clients.goals.cancel("g1")
    world.put_off(4, 5)
    assert world.clients.waiting == [3]
    assert world.clients.served == [1, 2, 4, 5], "those that are being cancelled go on"


def test_deferral_continues_search_if_everything_is_in_hand():
    world = World(3, bound=["1", "2", "3"])
    queue = world.clients.goals.queue
    planner, message = world.put_off(2, 3)
    assert (planner, message) == (world, "it took too long: the search goes on")
    assert (world.clients.waiting, queue.stuck) == ([], 1)
    assert world.clients.feed(STEP + 1) == []


def test_deferral_continues_search_if_no_goal_is_chosen():
    world = World(2)
    assert world.put_off() == (world, "it took too long: the search goes on")
    assert (world.clients.waiting, world.planners) == ([], [])


def test_deferral_preserves_order_of_chosen_goals():
    world = World(4, fresh="2")
    world.put_off(1, 2, 3)
    assert numbers(world.clients.goals.queue.waiting) == [1, 2, 3]
    assert [one.key for one in world.clients.reports if getattr(one, "waits", "")] == ["g1", "g2", "g3"]
