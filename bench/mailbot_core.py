"""The core with the mailbot's program on a floor, for benches that play the world to it without ROS."""

from pathlib import Path

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.reasoning import Core, CoreSettings
from rosoclingo.reasoning.stream_planner import unwatched

ENCODING = Path(__file__).resolve().parents[1] / "encodings" / "mailbot.lp"


class MailbotCore:
    """A pure core, plans made soon, its solver in a process of its own, as the node has both."""

    def __init__(self, floor, plan_time, settings=None):
        program = ReactiveProgram([Source.from_file(ENCODING), Source(floor.name, floor.instance)])
        self.process = WorkerPool(program, shortest=True, plan_time=plan_time, oclingo_strings=False, standby=True)
        self.core = Core(program, self.process.solver, self.note, settings or CoreSettings(), self.watch)

    def __enter__(self):
        self.process.start()
        self.core.start()
        return self

    def __exit__(self, *error):
        self.process.close()

    def add_goals(self, requests):
        """Send the goals of requests."""
        for request in requests:
            self.core.add_goal(str(request.number), request.goal)

    def advance(self, now=0.0):
        """Let the core go on until actions are out, or there is nothing to do."""
        while self.core.advance(now):
            pass

    def note(self, event):
        """Hear of an event of the core."""

    def watch(self):
        """Watch over a search, which goes on as long as it takes."""
        return unwatched()
