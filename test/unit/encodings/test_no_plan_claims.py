"""The delivery robot's proofs that no plan exists: they are right after any events, so no plan is lost."""

from functools import lru_cache

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from mailbot_world import ENCODINGS
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.oclingo.program.action_rules import STEPS, is_action_of
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.solver import PlanSolver

BOUND = sized(16, 24)
FLOORS = {
    "row": "corridor(o1,o2). corridor(o2,o3).",
    "loop": "corridor(o1,o2). corridor(o2,o3). corridor(o3,o1).",
}
WAYS = st.sampled_from(["o1,o2", "o2,o3", "o3,o1"])
GOALS = st.sampled_from(["o1,o3", "o3,o1", "o2,o3", "o1,o2"])
REASONS = st.sampled_from([*6 * [None], "blocked", "failed", "unknown_label", "preempted", "not_here", "not_at_label"])
LATER = st.sampled_from([0, 0, 0, 5])


@lru_cache(maxsize=None)
def program(floor, claims):
    """Return the mailbot, with or without the claims."""
    facts = " ".join(f"office(o{number})." for number in (1, 2, 3))
    text = f"#program base. start(o1). {facts} {FLOORS[floor]}"
    whole = ReactiveProgram([Source.from_file(ENCODINGS / "mailbot.lp"), Source("floor", text)])
    for part in whole.parts:
        part.statements = [one for one in part.statements if claims or not is_claim(one)]
    return whole


def is_claim(statement):
    return str(statement.ast).startswith(f"{STEPS.name}(#sup,")


@st.composite
def news(draw):
    """Generate the facts of an update, without its cycle, and the end of the action before."""
    way, number = draw(WAYS), draw(st.integers(1, 2))
    kinds = [
        f"_blocked({way},{{0}}+{draw(LATER)}).",
        f"_opened({way},{{0}}+{draw(LATER)}).",
        f"_request(cancel({number}),{{1}}).",
        f"_request(goal({draw(GOALS)},{number}),{{1}}+1).",
    ]
    return draw(REASONS), draw(st.lists(st.sampled_from(kinds), max_size=2, unique=True))


def term_text(step, action, reason, facts):
    """Return the update of a step, with the return of the action before it."""
    lines = [f"#step {step} : {BOUND}. #closed {step - 1}."]
    if action is not None:
        name, value = action.arguments[:2]
        lines += [f":- not {action}.", f"_return({name},{reason or value},{step - 1})."]
    lines += [evaluated(fact.format(step - 1, step)) for fact in facts]
    return parse_update(" ".join([*lines, "#endstep."]))


def evaluated(fact):
    """Return the fact with its cycle as a number."""
    head, _, cycle = fact.rstrip(").").rpartition(",")
    return f"{head},{sum(map(int, cycle.split('+')))})."


def test_no_plan_claims_are_the_omitted_rules():
    left_out = [one for part in program("row", True).parts for one in part.statements if is_claim(one)]
    assert len(left_out) == 2


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 4)
@given(st.sampled_from(sorted(FLOORS)), st.lists(news(), min_size=2, max_size=7))
def test_no_plan_claims_preserve_existing_plans(floor, updates):
    """Send the facts to both solvers and execute the plan of the first."""
    claiming, other = (PlanSolver(program(floor, claims)) for claims in (True, False))
    action = None
    for step, (reason, facts) in enumerate(updates, 1):
        update = term_text(step, action, reason, facts)
        ours, theirs = claiming.update(update), other.update(update)
        assert ours.outcome is theirs.outcome, str(update)
        action = None
        if ours.outcome is SolveOutcome.SATISFIABLE:
            assert ours.horizon == theirs.horizon
            action = next(filter(is_action_of(step), ours.answers[0]), None)
        elif claiming.horizon < other.horizon:
            event("refuted by a claim")
