"""The strategy for shortest plans: the horizons of its questions, and when it grounds more steps."""

from fake_grounding import FakeGrounding
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.planning.strategies.shortest import shortest

HORIZONS = st.integers(2, 12)
WORLDS = st.fixed_dictionaries(
    {
        "step": st.integers(1, 2),
        "horizon": HORIZONS,
        "most": st.integers(12, 20),
        "dead": st.none() | HORIZONS,
        "optimizes": st.booleans(),
    }
)


def run(answers, models=1, hint=0, block=1, **options):
    """Return the reply (None after a stop) and the questions."""
    world = FakeGrounding({horizon: [] for horizon in answers}, **{"most": 9, **options})
    return world.run(lambda runner: shortest(runner, models, hint), block)


@given(st.lists(HORIZONS, max_size=3), WORLDS, st.integers(0, 14), st.sampled_from([1, 8]), st.sampled_from([0, 1]))
def test_shortest_finds_the_least_horizon_unless_stopped(answers, world, hint, block, models):
    least = min((one for one in answers if one <= world["most"]), default=None)
    hopeless = world["dead"] is not None and (least is None or world["dead"] < least)
    reply, asked = run([] if hopeless else answers, models, hint, block, **world)
    assert (reply.satisfiable, reply.permanent) == (least is not None and not hopeless, hopeless)
    assert not reply.satisfiable or reply.horizon == least
    assert not reply.satisfiable or (models == 1 and not world["optimizes"]) or f"{least}..{least}!" in asked
    for halts in range(asked.count("..")):
        assert run(answers, models, hint, block, **world, halts=halts, cut=True)[0] is None
