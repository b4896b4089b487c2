"""Runs for tests of pages, as the topics publish them."""

import numpy as np
import yaml

from rosoclingo.common.reading import Reader
from rosoclingo.nodes.pages.order_desk import OrderDesk
from rosoclingo.runs.map_image import map_image
from rosoclingo.runs.orders import read_orders
from rosoclingo.runs.planar_frames import Pose
from rosoclingo.runs.recorded_run import ProgramFile, RunProgram
from rosoclingo.runs.run_view import RunView

LABELS = {"office1": [1.0, 1.0, 0.0], "office2": [5.0, 1.0, 0.0]}
GOAL = "goal(office2,office1,1)"

#: Orders of a page: two goals and a fact.
FORMS = """
- title: Deliver
  goal: "goal({from},{to},{package})"
  choices: {package: packages, from: place of package, to: labels}
- title: Patrol
  goal: "patrol({b},{a})"
  choices: {b: labels, a: labels}
- title: A place is open again
  fact: "_opened({place},now)"
  choices: {place: labels}
"""


def program_of(text, labels=None, **settings):
    """Return the program of a run, with labels and other settings of its core."""
    files = (ProgramFile("own.lp", text, False),)
    return RunProgram("run", files, {}, "", settings if labels is None else {"labels": labels, **settings})


def desk_of(core):
    """Return the desk of a page with the orders FORMS, for a core."""
    return OrderDesk(read_orders(Reader(yaml.safe_load(FORMS))), core)


def plan_of(*words):
    """Return actions one after the other from cycle 1 on, each "interface parameter"."""
    return ["_action_lib({},{},{})".format(*word.split(), cycle) for cycle, word in enumerate(words, 1)]


def delivery(program=None):
    """Return one goal that is met after four actions, the third of which failed once, beginning at 100 s.

    ``program`` is the text of the core's program, for its sentences.
    """
    view = RunView({"labels": LABELS, "title": "A delivery"})
    if program is not None:
        view.program(90.0, program)
    cells = np.zeros((40, 120), np.int8)
    cells[0] = cells[-1] = cells[:, 0] = cells[:, -1] = 100
    view.floor(map_image(cells.ravel().tolist(), 120, 0.05, Pose(0.0, 0.0, 0.0)))
    view.plan(90.0, 1, 1, [], (0.1, 0.0))
    view.pose(90.0, 1.0, 1.0, 0.0)
    view.packages(90.0, [("1", "office2"), ("2", "office1")])
    view.goal(100.0, "a", GOAL)
    view.update(101.0, f"#step 1.\n_request({GOAL},2).\n#end step.\n")
    plan = plan_of("move_base office2", "pickup 1", "move_base office1", "deliver 1")
    act(view, 101.0, 1, plan)
    view.status(101.5, "a", 1, f"{GOAL} is accepted")
    for second in range(1, 9):
        view.pose(101.0 + second, 1.0 + 0.5 * second, 1.0, 0.0)
    ends = ((110.0, "office2"), (112.0, "1"), (120.0, "blocked"))
    for number, (time, value) in enumerate(ends, 1):
        back(view, time, plan[number - 1], value, number)
        if number == 2:
            view.packages(time, [("1", ""), ("2", "office1")])
        if number < 3:
            act(view, time, number + 1, plan)
    again = [*plan[:3], "_action_lib(move_base,office1,4)", "_action_lib(deliver,1,5)"]
    for number, (time, value) in enumerate(((130.0, "office1"), (132.0, "1")), 4):
        act(view, time - 8.0 if number == 4 else time - 2.0, number, again)
        back(view, time, again[number - 1], value, number)
    view.packages(132.0, [("1", "office1"), ("2", "office1")])
    view.status(132.5, "a", 3, f"{GOAL} is met")
    view.finish()
    return view


def act(view, time, cycle, plan):
    """Publish a plan, and send its action of a cycle."""
    view.plan(time, cycle, len(plan), plan, (0.02, 0.01))
    view.dispatched(time, [plan[cycle - 1]])


def back(view, time, action, value, cycle):
    """Return an action to the core, which feeds the return."""
    text = f"_return({action.split('(')[1].split(',')[0]},{value},{cycle})"
    view.returned(time, "tests", [text])
    view.update(time, f"#step {cycle + 1}.\n:- not {action}.\n{text}.\n#end step.\n")
