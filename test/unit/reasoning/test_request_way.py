"""A request's way from the goal to the first action that goes out: how many files take part, and how deep calls go."""

import sys
from pathlib import Path

from rosoclingo import reasoning
from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver
from rosoclingo.reasoning import ActionsDispatched, Core, CoreSettings

ROOT = Path(__file__).resolve().parents[3]
SOURCES = str(Path(reasoning.__file__).parents[1]) + "/"

#: What a reader has to know; lower it when the way gets shorter.
MOST_FILES = 25
MOST_CALLS = 20


class Way:
    """Notes the package's files that take part in what is called, and the deepest chain of its calls."""

    def __init__(self):
        self.files, self.deepest = set(), []

    def __call__(self, frame, event, _argument):
        if event == "call" and frame.f_code.co_filename.startswith(SOURCES):
            self.files.add(frame.f_code.co_filename[len(SOURCES) :])
            calls = list(self.calls(frame))
            self.deepest = max(self.deepest, calls, key=len)

    @staticmethod
    def calls(frame):
        """Yield the package's functions that are at work, the innermost first."""
        while frame is not None:
            code = frame.f_code
            if code.co_filename.startswith(SOURCES):
                yield f"{code.co_filename[len(SOURCES) :]}: {code.co_name}"
            frame = frame.f_back


def way_of(goal, *files):
    """The way of the first goal of a core that has just been started."""
    program = ReactiveProgram.from_files([ROOT / "encodings" / name for name in files])
    way, sent = Way(), []

    def tell(event):
        if isinstance(event, ActionsDispatched):
            sys.setprofile(None)
            sent.append(event)

    core = Core(program, lambda: ReactiveSolver(program, shortest=True, oclingo_strings=False), tell, CoreSettings())
    core.start()
    before = sys.getprofile()
    sys.setprofile(way)
    try:
        core.add_goal("a", goal)
        while not sent and core.advance(0.0):
            pass
    finally:
        sys.setprofile(before)
    assert sent
    return way


def test_a_request_takes_a_short_way_to_its_first_action():
    way = way_of("goal(office3,office2,1)", "mailbot.lp", "office.lp")
    assert len(way.files) <= MOST_FILES, "\n".join(sorted(way.files))
    assert len(way.deepest) <= MOST_CALLS, "\n".join(reversed(way.deepest))
