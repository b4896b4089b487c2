"""Control programs as goals of a core: messages, preempted actions, and programs of a domain with requests."""

from functools import lru_cache

import pytest
from core_scripts import scripts
from golog_scripts import domain_with, run
from shipped import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.settings import CoreSettings

PROCEDURES = """
proc other { a; await f; b; }
proc other(X) { pick Y: is(Y) and X = Y { if Y = a { a; } else { b; } } }
proc pair { a; b; }
proc waiting { await g; d; }
proc tried { try { retry 1 { a; b; } } else { c; } }
proc nested { do { do { a; b; } on cancel { c; } } on cancel { tidy; } }
proc both { interleave { do { a; await f; } on cancel { c; } } with { do { d; await f; } on cancel { tidy; } } }
proc untrue { test f; }
proc unpicked { pick X: is(X) and f { a; } }
"""


@lru_cache(maxsize=None)
def program():
    """Return the procedures in the domain."""
    return domain_with(PROCEDURES)


SCENES = {
    "goal that names itself is cancelled by that": "goal h run(other); cancel h; succeed; is h preempted",
    "programs that there are not are rejected": """
        goal g run(othr,1); goal h run(other(1,2),2); says g the program rejects run(othr,1): there is no program othr
        says h the program rejects run(other(1,2),2): there is no program other(1,2)""",
    "preempted program tries again": f"""
        goal g run(pair,1); {"breaks a preempted;" * 5} performs a b""",
    "failures are counted again when a program is asked for or cancelled": """
        goal g run(pair,1); breaks a; breaks a; goal h run(waiting,2); breaks a; breaks a; cancel h; breaks a; breaks a
        is g active; is h preempted; performs a b""",
    "reason of failures": """
        goal g run(pair,1); breaks a; breaks a; breaks a; does; says g ...a has failed 3 times in a row...""",
}  # fmt: skip


@pytest.mark.slow
@scripts(SCENES)
def test_golog_scene_follows_the_script(row):
    run(program(), row)


@pytest.mark.slow
def test_golog_retries_once_and_undoes_all_begun_programs_inner_ones_first():
    run(program(), "goal g run(tried,1); step a; breaks b; step a; breaks b; performs c; is g succeeded")
    run(program(), "goal g run(nested,1); step a; cancel g; fail stuck; performs c tidy; is g preempted")
    driver = run(program(), "goal g run(both,1); finish; cancel g; finish; is g preempted")
    assert sorted(one.split(",")[1] for one in driver.journal.actions) == ["a", "c", "d", "tidy"]


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("untrue", "the test in line {} of test.golog does not hold"),
        ("unpicked", "there is nothing to pick in line {} of test.golog"),
    ],
)
def test_golog_reason_names_where_a_program_is_stuck(name, why):
    line = PROCEDURES.partition(f"proc {name} ")[0].count("\n") + 1
    assert why.format(line) in run(program(), f"goal g run({name},1)").message("g")


#: A search that waits for the evening, and a request for one that would wait at once.
HOLDING = """
proc hold { alone { go(office2); await hour(evening); go(office1); } }
proc wait { alone { go(office2); if hour(morning) { await hour(evening); } go(office1); } }
"""


@lru_cache(maxsize=None)
def mailbot():
    """Return the mailbot's program with its day and the programs above."""
    files = [ENCODINGS / name for name in ("mailbot.lp", "office.lp", "golog/mailbot_day.golog")]
    more = Source("more.golog", f'include "mailbot_day.golog";{HOLDING}', ENCODINGS / "golog")
    return ReactiveProgram([*map(Source.from_file, files), more])


@pytest.mark.slow
def test_golog_domain_requests_are_served_with_programs():
    driver = run(mailbot(), """
        goal round run(morning_round); goal mail goal(office2,office4,1); finish; is round succeeded; is mail succeeded
        """)  # fmt: skip
    assert driver.core.cycle <= 8


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize(("first", "end"), [("hold", "facts _hour(evening,now)"), ("wait", "cancel g")])
def test_golog_domain_request_waits_during_a_search(first, end):
    run(
        mailbot(),
        f"""
        facts _hour(morning,now); goal g run({first}); goal early goal(office4,office1,1); succeed; does
        goal late goal(office3,office1,2); is early active; is late active; goal off goal(office3,office1,3)
        cancel off; is off preempted; {end}; finish; is early succeeded; is late succeeded""",
        CoreSettings(),
    )
