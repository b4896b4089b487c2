"""The report in a browser: its views, its slider, hostile texts, a long run."""

import json
import re
from pathlib import Path

import pytest
from published_runs import GOAL, LABELS, delivery, long_run

from rosoclingo.runs.recorded_run import ProgramFile, RunProgram
from rosoclingo.runs.report_page import SCRIPTS, report_page
from rosoclingo.runs.run_view import RunView

WEB = Path(__file__).resolve().parents[3] / "web"
HOSTILE = [
    "<script>window.broken = 1</script>",
    "</script><script>window.broken = 1</script>",
    "<img src=x onerror='window.broken = 1'>",
    "\u2028]]><!-- script -->",
    '" onclick="window.broken = 1',
    "{{constructor}}",
]
pytestmark = [pytest.mark.slow, pytest.mark.once]


def write(folder, view):
    page = report_page(view.changes(), WEB)
    path = folder / "run.html"
    path.write_text(page, encoding="utf-8")
    return path


@pytest.fixture
def opened(page, tmp_path):
    def open_run(view):
        page.faults.clear()
        page.open(write(tmp_path, view).as_uri())
        return page

    yield open_run
    assert page.faults == []


def move(page, time):
    script = (
        "const slider = document.getElementById('slider'); slider.value = {}; slider.dispatchEvent(new Event('input'))"
    )
    page.run("{" + script.format(time) + "}")


def test_report_page_is_one_file_with_all_scripts():
    text = report_page(delivery().changes(), WEB)
    assert {path.name for path in WEB.iterdir()} >= {*SCRIPTS, "page.css", "report.html"}
    assert not re.search(r"<!-- (policy|style|run|script) -->", text)
    assert not re.search(r"(src|href)=[\"']?(https?:|//)", text)
    run = re.search(r'<script type="application/json" id="run">(.*?)</script>', text, re.DOTALL).group(1)
    assert json.loads(run)["goals"][0][1]["request"] == GOAL


def test_report_page_shows_the_end_first(opened):
    page = opened(delivery())
    assert page.text("h1") == "A delivery"
    assert page.text("#clock") == "32.5 s · cycle 6"
    assert "1 goal: 1 succeeded" in page.text("#facts")
    assert page.texts("#goals tbody td") == ["succeeded", "32.5 s", ""]
    assert page.text("#map .caption") == "The robot is at office2. Things: 1, 2 at office1."
    assert page.run("document.querySelector('.floor').getBoundingClientRect().width") > 300


def test_report_page_slider_shows_a_moment(opened):
    page = opened(delivery())
    move(page, 10.5)
    assert page.text("#clock") == "10.5 s · cycle 2"
    assert page.texts("#cycle li") == ["✓ move_base office2", "▶ pickup 1", "○ move_base office1", "○ deliver 1"]
    assert "_return(move_base,office2,1)." in page.text("#cycle pre")
    assert page.texts("#goals tbody td")[:2] == ["active", "10.5 s"]
    assert len(page.texts(".timeline .bar.ahead")) == 2
    assert page.texts(".log [aria-current] .text") == ["pickup 1"]
    move(page, 13.0)
    assert "It carries 1." in page.text("#map .caption")
    move(page, 0)
    assert page.texts("#goals tbody td")[0] == "pending"


def test_report_page_draws_preempted_action_as_ended_early(opened):
    view = delivery()
    view.plan(140.0, 6, 8, ["_action_lib(move_base,office1,6)"], (0.01, 0.01))
    view.dispatched(140.0, ["_action_lib(move_base,office1,6)"])
    view.dispatched(141.0, ["_cancel(move_base,office1,6)"])
    view.returned(142.0, "tests", ["_return(move_base,preempted,6)"])
    view.plan(142.5, 6, 8, ["_action_lib(move_base,office1,6)"], (0.01, 0.01))
    page = opened(view)
    assert page.texts("#cycle li") == ["– move_base office1: preempted"]
    assert page.run("document.querySelectorAll('.timeline .bar.gone').length") == 1
    assert "Not reached" not in page.text("#map .caption")
    assert "ended early" in page.text(".keys")


def test_report_page_marks_a_failed_action(opened):
    page = opened(delivery())
    move(page, 21.0)
    assert "✕ move_base office1: blocked" in page.texts("#cycle li")
    assert "Not reached: office1 (blocked)." in page.text("#map .caption")
    assert page.texts(".map .wayname.bad") == ["✕ blocked"]
    move(page, 31.0)
    assert "Not reached" not in page.text("#map .caption")


def floor(*facts):
    """Return a program with drawings on the map, as published by the core."""
    text = "\n".join(("_draws(door,way). _draws(shut,blocked). _draws(on,thing). _draws(me,robot).", *facts))
    labels = {"hall": [1.0, 1.0, 0.0], "study": [5.0, 1.0, 0.0]}
    return RunProgram("r", (ProgramFile("floor.lp", text, False),), {}, "", {"labels": labels}).text()


def test_report_page_shows_drawings_of_the_program(opened):
    view = RunView()
    view.program(0.0, floor("door(hall,study).", '_draws(dirt,mark,"dirt: {}").'))
    view.goal(0.0, "a", "g(1)")
    view.beliefs(1.0, 1, ["on(cup,study,now)", "me(hall,now)"])
    view.beliefs(2.0, 1, ["on(cup,study,now)", "me(study,now)", "shut(study,hall,now)", "dirt(much,hall,now)"])
    page = opened(view)
    move(page, 1.0)
    assert (len(page.texts(".map .way")), len(page.texts(".map .barrier"))) == (1, 0)
    known = "According to the program, the robot is at {}. Things: cup at study."
    assert page.text("#map .caption") == known.format("hall")
    left = "document.querySelector('.map .robot').getBoundingClientRect().x"
    before = page.run(left)
    move(page, 2.0)
    assert (len(page.texts(".map .way")), len(page.texts(".map .barrier"))) == (2, 1)
    assert page.text("#map .caption") == known.format("study") + " study – hall: blocked. hall: dirt: much."
    assert page.texts(".map .wayname") == ["dirt: much"]
    assert page.run(left) > before + 100


def test_report_page_prefers_observations_to_beliefs(opened):
    view = delivery()
    view.program(0.0, floor())
    view.beliefs(132.4, 6, ["on(9,study,now)", "me(hall,now)"])
    view.describe(labels={**LABELS, "hall": [3.0, 1.0, 0.0], "study": [3.5, 1.0, 0.0]})
    assert opened(view).text("#map .caption") == "The robot is at office2. Things: 1, 2 at office1."


def test_report_page_shows_the_figures(opened):
    page = opened(delivery())
    found = dict(zip(page.texts("figcaption strong"), page.texts("figcaption span")))
    assert found["Goals by their end"] == "1 goal"
    assert found["Time until the end"] == "median 32.5 s, longest 32.5 s"
    assert found["Response: time until accepted"] == "median 1.5 s, longest 1.5 s"
    assert found["Solver's time"] == "250 ms of wall time, 130 ms in the longest cycle"
    assert found["Metres driven"] == "4.0 m"


def test_report_page_is_usable_by_keyboard(opened):
    page = opened(delivery())
    page.press("Home", "#slider")
    assert page.text("#clock") == "0.0 s · cycle 1"
    page.press("ArrowRight", ".log")
    assert page.text("#clock") == "10.0 s · cycle 2"
    page.press("ArrowLeft", ".log")
    assert page.text("#clock") == "0.0 s · cycle 1"
    page.press("Enter", ".log li:last-child button")
    assert page.text("#clock") == "32.5 s · cycle 6"


def test_report_page_timeline_click_jumps_and_play_continues(opened):
    page = opened(delivery())
    page.click(".timeline")
    here = page.run("player.time")
    assert 5.0 < here < 25.0
    page.click("#play")
    page.wait_for(f"player.time > {here} + 0.5")
    page.click("#play")
    assert page.text("#play") == "Play"


def test_report_page_address_names_a_moment(page, tmp_path):
    page.open(write(tmp_path, delivery()).as_uri() + "#t=12.5")
    assert page.text("#clock").startswith("12.5 s")


@pytest.mark.parametrize("verdict", [[], ["goals: expected <b>"]])
def test_report_page_shows_the_verdict(opened, verdict):
    view = delivery()
    view.describe(verdict=verdict)
    text = opened(view).text("#verdict")
    assert text.split("\n") == (["Not as expected", *verdict] if verdict else ["As expected"])


@pytest.mark.parametrize("text", HOSTILE)
def test_report_page_escapes_hostile_texts(opened, text):
    view = RunView({"title": text, "source": text, "verdict": [text], "lacks": text})
    quoted = text.replace("\\", "\\\\").replace('"', '\\"')
    view.program(0.0, floor(f'_draws(sign,mark,"{quoted}").'))
    view.describe(labels={**view.about["labels"], text: [1.0, 1.0, 0.0]})
    view.goal(0.0, text, text)
    view.status(1.0, text, 5, text)
    view.update(1.0, text)
    view.plan(1.0, 1, 1, [text], (0.0, 0.0))
    view.returned(1.0, text, [text])
    view.packages(1.0, [(text, text)])
    view.beliefs(1.0, 1, [text, "sign(hall)"])
    view.problem(1.0, 1, text)
    view.pose(1.0, 1.0, 1.0, 0.0)
    view.finish()
    page = opened(view)
    assert page.run("window.broken") is None
    assert page.texts("#goals code") == [text]
    assert text in page.texts(".labelname")
    sign = text.strip()
    assert page.texts(".map .wayname") == [sign if len(sign) <= 30 else f"{sign[:29]}…"]
    assert text in page.texts(".atoms code")
    assert page.texts("h1") == [text]


def test_report_page_shows_an_empty_run(opened):
    page = opened(RunView())
    assert page.text("#map .caption") == "The robot's place was not recorded."
    assert page.text("#cycle") == "No cycle has begun yet."
    assert "No goals yet." in page.text("#goals")


@pytest.mark.parametrize("width", [360, 1280])
def test_report_page_is_no_wider_than_the_window(opened, page, width):
    view = delivery()
    view.goal(140.0, "b", f"goal({'x' * 300},1)")
    page.size(width, 740)
    opened(view)
    assert page.run("document.documentElement.scrollWidth") <= width
    page.size(1280, 900)


def test_report_page_of_many_goals_is_small_and_fast(opened, tmp_path):
    view = long_run()
    assert write(tmp_path, view).stat().st_size < 5_000_000
    page = opened(view)
    assert page.text("#clock").endswith("cycle 1200")
    assert len(page.texts("#goals tbody tr")) == 200
    used = "performance.getEntriesByType('navigation')[0].loadEventEnd"
    drawn = "(() => { const start = performance.now(); player.seek(3000.5); return performance.now() - start; })()"
    print("loaded after", page.wait_for(used), "ms, moment drawn in", page.run(drawn), "ms")
    assert page.text("#clock").endswith("cycle 301")
