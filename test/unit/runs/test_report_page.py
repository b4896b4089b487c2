"""The report in a browser: its views, its slider, hostile texts, a long run."""

import json
import re
from pathlib import Path

import pytest
from published_runs import GOAL, LABELS, delivery, program_of

from rosoclingo.runs.report_page import SCRIPTS, report_page
from rosoclingo.runs.run_view import RunView

WEB = Path(__file__).resolve().parents[3] / "web"
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


WORDS = """
_says(move_base,"drives to {}"). _says(pickup,"picks up {}"). _says(deliver,"puts down {}").
_says("goal(From,To,Id)","Bring package {Id} from {From} to {To}").
"""


def worded(text=WORDS, **titles):
    """Return a program with sentences, as published by the core."""
    return program_of(text, LABELS, titles=titles).text()


def test_report_page_begins_with_the_whole_run(opened):
    page = opened(delivery())
    assert page.text("h1") == "A delivery"
    assert page.text("#clock") == "whole run, 32.5 s"
    assert "1 goal: 1 done" in page.text("#facts")
    assert page.texts("#goals tbody td") == ["done", "32.5 s", ""]
    assert page.text("#map .caption") == "The whole way: 4.0 m. The robot is at office2. Things: 1, 2 at office1."
    assert page.run("document.querySelector('.floor').getBoundingClientRect().width") > 300
    assert page.text("#planhead") == "The run"
    found = dict(zip(page.texts("#plan dt"), page.texts("#plan dd")))
    assert found["goals"] == "1 done"
    assert found["goals took"] == "32.5 s"
    assert found["actions"] == "4 done, 1 failed"
    assert found["search for plans"] == "250 ms of the solver, at most 130 ms for a cycle"
    assert page.texts(".map .number") == page.texts(".timeline .bar.ahead") == []
    figures = dict(zip(page.texts("figcaption strong, #charts dt"), page.texts("figcaption span, #charts dd")))
    assert figures["Goals by their end"] == "1 goal"
    assert figures["Response: time until accepted"] == "1.5 s"
    assert figures["Search for plans"] == "250 ms of wall time, 130 ms in the longest cycle"
    assert figures["Metres driven"] == "4.0 m"
    assert found["time"] == "32.5 s"
    tops = page.run("['goals', 'map', 'log'].map((one) => document.getElementById(one).getBoundingClientRect().y)")
    assert tops == sorted(tops)
    page.press("ArrowRight")
    assert page.text("#clock") == "0.0 s · cycle 1"
    assert page.text("#planhead") == "Plan"
    page.click("#whole")
    assert page.text("#clock") == "whole run, 32.5 s"


def test_report_page_speaks_the_words_of_the_program(opened):
    page = opened(delivery(worded(office1="Anna's <b>office</b>")))
    sentence = "Bring package 1 from office2 to Anna's <b>office</b>"
    assert page.texts("#goals summary") == [sentence]
    move(page, 10.5)
    assert page.texts("#plan li") == [
        "✓ drives to office2",
        "▶ picks up 1",
        "○ drives to Anna's <b>office</b>",
        "○ puts down 1",
    ]
    assert "Anna's <b>office</b>" in page.texts(".map .labelname")
    lines = page.texts(".log .text summary")
    assert f"{sentence}: done" in page.texts(".log .text summary")
    assert "drives to office2: done" in lines
    visible = page.run("document.querySelector('main').innerText")
    assert not [
        term for term in ("goal(", "_request", "_return", "_action_lib", "move_base", "#step") if term in visible
    ]
    assert page.run("document.querySelectorAll('main b').length") == 0
    page.click("#goals summary")
    assert GOAL in page.text("#goals tbody th")
    page.click("#plan > details:last-child > summary")
    shown = page.text("#plan")
    assert "_action_lib(pickup,1,2)" in shown
    assert "_return(move_base,office2,1)." in shown
    move(page, 11.0)
    assert "_action_lib(pickup,1,2)" in page.text("#plan"), "stays open"


def test_report_page_slider_shows_a_moment(opened):
    page = opened(delivery())
    move(page, 10.5)
    assert page.text("#clock") == "10.5 s · cycle 2"
    assert page.texts("#plan li") == ["✓ move_base office2", "▶ pickup 1", "○ move_base office1", "○ deliver 1"]
    assert "_return(move_base,office2,1)." in page.texts("#plan pre")[1]
    assert page.texts("#goals tbody td")[:2] == ["under way", "10.5 s"]
    assert len(page.texts(".timeline .bar.ahead")) == 2
    assert page.texts(".log [aria-current] .text summary") == ["pickup 1"]
    move(page, 13.0)
    assert "It carries 1." in page.text("#map .caption")
    move(page, 0)
    assert page.texts("#goals tbody td")[0] == "new"


def test_report_page_marks_failed_and_preempted_actions(opened):
    view = delivery()
    view.plan(140.0, 6, 8, ["_action_lib(move_base,office1,6)"], (0.01, 0.01))
    view.dispatched(140.0, ["_action_lib(move_base,office1,6)"])
    view.dispatched(141.0, ["_cancel(move_base,office1,6)"])
    view.returned(142.0, "tests", ["_return(move_base,preempted,6)"])
    view.plan(142.5, 6, 8, ["_action_lib(move_base,office1,6)"], (0.01, 0.01))
    page = opened(view)
    move(page, 21.0)
    assert "✕ move_base office1: blocked" in page.texts("#plan li")
    assert "Not reached: office1 (blocked)." in page.text("#map .caption")
    assert page.texts(".map .wayname.bad") == ["✕ blocked"]
    move(page, 31.0)
    assert "Not reached" not in page.text("#map .caption")
    move(page, 42.5)
    assert page.texts("#plan li") == ["– move_base office1: preempted"]
    assert page.run("document.querySelectorAll('.timeline .bar.gone').length") == 1


def floor(*facts):
    """Return a program with drawings on the map, as published by the core."""
    text = "\n".join(("_draws(door,way). _draws(shut,blocked). _draws(on,thing). _draws(me,robot).", *facts))
    return program_of(text, {"hall": [1.0, 1.0, 0.0], "study": [5.0, 1.0, 0.0]}).text()


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


def test_report_page_escapes_hostile_texts(opened):
    text = (
        "</script><script>window.broken = 1</script><img src=x onerror='window.broken = 1'>\u2028]]><!-- script -->"
        '" onclick="window.broken = 1 {{constructor}} ${1} \u202eright to left\u202c'
    )
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
    assert page.texts("#goals tbody th") == [text]
    short = f"{text[:29]}…{text}"  # the whole text is its title
    assert short in page.texts(".labelname")
    assert page.texts(".map .wayname") == [short]
    move(page, 1.0)
    assert text in page.texts(".atoms code")
    assert page.texts("h1") == [text]


# ---- map and timeline ------------------------------------------------------------------------------------------------


def fleet(robots=2, names=("r1", "r2", "<b>r</b>")):
    """Return a run of several robots that only tf knows, each with three drives ahead."""
    view = RunView()
    labels = {f"p{number}": [2.0 * number, 0.0, 0.0] for number in range(5)}
    view.program(0.0, program_of('_says(go,"drives to {}").', labels).text())
    view.goal(0.0, "a", "g(1)")
    plan = [f'_action_lib(go("{name}"),p{step},{step})' for step in (1, 2, 3, 4) for name in names[:robots]]
    view.plan(1.0, 1, 4, plan, (0.01, 0.01))
    view.dispatched(1.0, plan[:robots])
    for number, name in enumerate(names[:robots]):
        view.pose(2.0, 0.5, 0.3 * number, 0.0, name)
        view.pose(4.0, 1.0, 0.3 * number, 0.0, name)
    view.clock(5.0)
    view.finish()
    return view


@pytest.mark.parametrize("robots", [1, 3])
def test_report_page_shows_each_robot_with_colour_plan_and_place(opened, robots):
    page = opened(fleet(robots))
    move(page, 4.0)
    names = sorted(["r1", "r2", "<b>r</b>"][:robots])
    assert page.texts(".robots strong") == names
    assert page.texts(".map .robotname") == names
    assert (
        page.texts(".robots li")[-1].strip() == f"{names[-1]} on its way; drives to p1, then drives to p2, drives to p3"
    )
    colours = (
        "[...new Set([...document.querySelectorAll('.map .robot circle')].map((one) => getComputedStyle(one).fill))]"
    )
    assert len(page.run(colours)) == robots
    assert page.texts(".map .number text") == ["1", "2"] * robots
    assert len(page.texts(".map .ahead.faint")) == 2 * robots
    assert (
        len(page.run("[...document.querySelectorAll('.map .driven')].map((one) => one.getAttribute('points'))"))
        == robots
    )
    assert page.texts(".timeline .robotname title") == names
    faint = "document.querySelectorAll('.map .ahead.faint')[0]"
    assert page.run(f"getComputedStyle({faint}).opacity < 0.5")
