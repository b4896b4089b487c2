"""What interfaces tell the core: returns of the actions under way, and other facts; what of it makes no sense."""

from contextlib import contextmanager
from typing import Callable, Iterator, Optional, Sequence, Tuple

from clingo import Symbol

from rosoclingo.oclingo import ProgressionError, ReactiveProgram, parse_atom
from rosoclingo.reasoning.dispatch import Dispatch, ReturnError
from rosoclingo.reasoning.events import Event, FactTaken, Problem, ReturnTaken
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import RESERVED, RETURN, TIMEOUT, Action, KeywordError, Return, is_keyword, return_of
from rosoclingo.reasoning.observations import Observations


class FactError(ValueError):
    """A fact that no interface may state, or that the program has no use for; the text says why."""


class Intake:
    """Takes facts into the feeder, counts returns of the ``dispatch`` under way, and remembers ``observations``."""

    def __init__(
        self, program: ReactiveProgram, feeder: InputFeeder, tell: Callable[[Event], None], cycle: Callable[[], int]
    ) -> None:
        self._program = program
        self._feeder = feeder
        self._tell = tell
        self._cycle = cycle
        self.dispatch: Optional[Dispatch] = None
        self.observations = Observations()

    @property
    def awaited(self) -> Tuple[Action, ...]:
        """The actions under way that have not returned."""
        return self.dispatch.missing if self.dispatch else ()

    def receive(self, origin: str, facts: Sequence[str]) -> None:
        """Facts from the interface ``origin``. One that makes no sense is told as a problem, and the rest are taken."""
        for text in facts:
            with self._guarded(origin, text):
                self._take(parse_atom(text))

    def expire(self, now: float, limit: float) -> None:
        """Actions that have not returned within ``limit`` seconds count as failed; 0 waits for ever."""
        if self.dispatch is None or limit <= 0:
            return
        self.dispatch.started = min(self.dispatch.started, now)  # time jumped back: the wait begins anew
        if now - self.dispatch.started < limit:
            return
        for action in self.dispatch.expire(TIMEOUT):
            text = f"{action.atom} has not returned within {limit:g} s: it counts as failed"
            self._tell(Problem(self._cycle(), text, action.interface_name))
            atom = Return(action.interface, TIMEOUT, action.cycle).atom
            with self._guarded(action.interface_name, str(atom)):
                self._feed_return(atom)

    def end_cycle(self) -> Tuple[Action, ...]:
        """The actions that were executed in the cycle, which is over."""
        dispatch, self.dispatch = self.dispatch, None
        if dispatch is None:
            return ()
        for answer, actions in dispatch.failures:
            self.observations.add_failure(answer, actions)
        return dispatch.actions

    @contextmanager
    def _guarded(self, origin: str, text: str) -> Iterator[None]:
        """Tell as a problem why the fact ``text`` makes no sense."""
        try:
            yield
        except (ProgressionError, KeywordError, ReturnError, FactError) as error:
            self._tell(Problem(self._cycle(), f"'{text}' from '{origin}' is ignored: {error}", origin))

    def _take(self, atom: Symbol) -> None:
        """Raises KeywordError for a malformed return, ReturnError when no action waits for it, FactError."""
        if is_keyword(atom, RETURN):
            answer = return_of(atom)
            if self.dispatch is None:
                raise ReturnError("no action is under way")
            self.dispatch.take(answer)
            self._feed_return(atom)
        else:
            self._check(atom)
            self.observations.add_fact(atom, self._cycle())
            self._tell(FactTaken(self._cycle(), atom))
            self._feeder.add_fact(atom)

    def _feed_return(self, atom: Symbol) -> None:
        """Pass on a return that has been counted."""
        self._tell(ReturnTaken(self._cycle(), atom))
        self._check(atom)
        self._feeder.add_fact(atom)

    def _check(self, atom: Symbol) -> None:
        """Raises FactError when ``atom`` is one of the core's own keywords or no external of the program."""
        signature = (atom.name, len(atom.arguments))
        if signature in RESERVED:
            raise FactError("{}/{} is for the core and the program only".format(*signature))
        if not self._program.declares_external(*signature):
            raise FactError("the program declares no external {}/{}".format(*signature))
