"""Questions about an update: whether a plan obeys selected rules, given selected facts of the stream."""

from dataclasses import replace
from typing import FrozenSet, Iterable, List, NamedTuple, Optional

import clingo

from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.planning.explaining.relaxed_program import RelaxedProgram
from rosoclingo.planning.history import History, entry_from_message, entry_to_message
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Reply, Stop
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.text import Message

Facts = FrozenSet[clingo.Symbol]


class Stream(NamedTuple):
    """A history, the next update, and a bound for plans.

    Attributes:
        log: the history.
        update: the update that follows it.
        steps: the greatest number of steps of a plan.

    """

    log: History
    update: StreamUpdate
    steps: int


def stream_to_message(stream: Stream) -> Message:
    """Return a stream as a message."""
    return {**stream._asdict(), "log": [*map(entry_to_message, stream.log.entries)], "update": str(stream.update)}


def stream_from_message(message: Message) -> Stream:
    """Return the stream in a message of :func:`stream_to_message`."""
    log = History().with_entries(*map(entry_from_message, message["log"]))
    return Stream(**{**message, "log": log, "update": parse_update(message["update"])})


class Questions:
    """Asks a relaxed program about a stream.

    Attributes:
        step: the step of the stream's update.
        facts: the assumable facts of the stream, and the executed actions.

    """

    def __init__(self, program: RelaxedProgram, stream: Stream, idles: bool, halt: Stop) -> None:
        """Restore the history of ``stream``.

        ``idles``: whether answers can be extended by idle steps. ``halt`` stops a question.
        """
        self._stream, self._idles, self._halt = stream, idles, halt
        self._solver = PlanSolver(program, idles=idles)
        self._solver.restore(stream.log)
        before, update = self._solver.snapshot, stream.update
        self.step = before.step if update.step is None else update.step
        statements = [*before.statements, *(one for _, one in update.sections())]
        plain = (one for one in statements if one.is_commitment or not one.body)  # actions can depend on facts
        self.facts = frozenset(one.subject for one in plain if one.subject is not None)

    def with_program(self, program: RelaxedProgram) -> "Questions":
        """Return the questions about the same stream for another program."""
        return Questions(program, self._stream, self._idles, self._halt)

    def ask(self, kept: Iterable[clingo.Symbol], facts: Optional[Facts] = None, steps: Optional[int] = None) -> Reply:
        """Search for a plan with the selectors ``kept`` and the ``facts`` (None: all).

        Raises UndecidedError after a stop, and SolverError if the update is rejected.
        """
        disabled = frozenset() if facts is None else self.facts - facts
        update = replace(self._stream.update, bound=self._stream.steps if steps is None else steps)
        reply = self._solver.inquire(update, self.facts, disabled, self._halt, sorted(kept), believes=False)
        if reply.satisfiable is None:
            raise UndecidedError
        return reply

    def known(self) -> List[clingo.Symbol]:
        """Return all atoms that can be true at the grounded steps."""
        return self._solver.probed_atoms()

    def shortest(self, kept: Iterable[clingo.Symbol], found: Reply) -> Reply:
        """Return the shortest plan with the selectors ``kept``, given a plan ``found`` before."""
        kept = list(kept)
        low, best = 0, found
        while low < best.horizon - self.step:
            middle = (low + best.horizon - self.step) // 2
            reply = self.ask(kept, steps=middle)
            if not reply.satisfiable:
                low = middle + 1
            elif reply.horizon < best.horizon:
                best = reply
            else:  # the history already requires this horizon
                break
        return best
