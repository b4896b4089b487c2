"""The moves of a run: goals and cancels arrive, facts are reported, actions return."""

from itertools import combinations, product
from typing import Container, Dict, FrozenSet, Iterable, Iterator, List, Mapping, NamedTuple, Sequence, Tuple

from clingo import Function, Symbol, SymbolType

from rosoclingo.checking.verifying.scope import VerifyLimits
from rosoclingo.checking.verifying.shared_solver import redate
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import Clock
from rosoclingo.reasoning.keywords import FAILED, FAILURE, RUNNING, Action, Return, failure_value, name_of

GOAL, CANCEL, FACT = "goal", "cancel of", "fact"
"""The kinds of arrivals, in words."""


class Arrival(NamedTuple):
    """An event from outside: a ``kind``, and the goal, the goal to cancel, or the fact."""

    kind: str
    term: Symbol


class ActionEnd(NamedTuple):
    """The end of an action; ``value`` is its parameter if it succeeded."""

    action: Action
    value: Symbol

    @property
    def fails(self) -> bool:
        """Whether the action failed."""
        return self.value != self.action.parameter

    @property
    def text(self) -> str:
        """The return as an interface sends it."""
        return str(Return(self.action.interface, self.value, self.action.cycle).atom)


class Move(NamedTuple):
    """The events before the next update: arrivals in order, then the returns of running actions."""

    arrivals: Tuple[Arrival, ...] = ()
    answers: Tuple[ActionEnd, ...] = ()

    @property
    def cost(self) -> int:
        """The number of events, without successes."""
        return len(self.arrivals) + len(self.failures)

    @property
    def failures(self) -> Tuple[ActionEnd, ...]:
        """The actions that fail."""
        return tuple(one for one in self.answers if one.fails)

    def ends_as(self, other: "Move") -> bool:
        """Return whether the same actions return."""
        return [one.action for one in self.answers] == [one.action for one in other.answers]


class Repertory(NamedTuple):
    """The events that can occur.

    Attributes:
        goals: the goals.
        facts: the facts, of cycle 1.
        reasons: the return values of failed actions, by interface.

    """

    goals: Tuple[Symbol, ...]
    facts: Tuple[Symbol, ...]
    reasons: Mapping[str, Tuple[Symbol, ...]]


class Moves:
    """Generates the moves of states."""

    def __init__(self, program: ReactiveProgram, repertory: Repertory, limits: VerifyLimits) -> None:
        self._program, self._repertory, self._limits = program, repertory, limits
        self._parameters: Dict[Symbol, List[Symbol]] = {}
        self._clock = Clock(program.delay_of, program.first_step)

    def moves(
        self, awaited: Sequence[Action], goals: Sequence[Goal], step: int, due: bool, left: int
    ) -> Iterator[Move]:
        """Yield the moves of at most ``left`` events, those with fewer events first.

        ``step`` is that of the next update. Without a return, an event is required unless the core is ``due``.
        """
        arrivals = self._arrivals(goals, step) if left else []
        for count in range(min(left, self._limits.together) + 1):
            for failing in range(min(count, len(awaited)) + 1):
                for some in combinations(arrivals, count - failing):
                    for answers in self._answers(awaited, failing):
                        if answers or due or some:
                            yield Move(some, answers)

    def returns(self, actions: Iterable[Tuple[Symbol, Symbol]]) -> Iterator[Symbol]:
        """Yield the likely returns and running actions, of cycle 1, of actions given by name and parameter."""
        for name, parameter in sorted(actions):
            known = self._parameters.setdefault(name, [])
            known += [] if parameter in known else [parameter]
            if self._program.declares_external(RUNNING, 3):
                yield Action(name, parameter, 1).running
            for value in (parameter, *self._reasons(name)):
                yield Return(name, value, 1).atom
                if self._program.declares_external(FAILED, 3):
                    yield Function(FAILED, Return(name, value, 1).atom.arguments)

    def _reasons(self, interface: Symbol) -> Tuple[Symbol, ...]:
        return self._repertory.reasons.get(name_of(interface), (FAILURE,))

    def _answers(self, awaited: Sequence[Action], failing: int) -> Iterator[Tuple[ActionEnd, ...]]:
        """Yield the returns of all running actions or, if actions can go on, also of some of them."""
        least = failing if self._program.declares_external(RUNNING, 3) else len(awaited)
        ended = (some for count in range(len(awaited), least - 1, -1) for some in combinations(awaited, count))
        for actions in ended:
            for chosen in combinations(actions, failing):
                values = [self._failures(one, awaited) if one in chosen else (one.parameter,) for one in actions]
                for some in product(*values):
                    yield tuple(map(ActionEnd, actions, some))

    def _failures(self, action: Action, awaited: Sequence[Action]) -> Sequence[Symbol]:
        """Return the return values of a failure: the reasons, and the parameter of another action."""
        same = [one.parameter for one in awaited if one.interface == action.interface]
        others = [one for one in self._parameters.get(action.interface, ()) if one not in same]
        reasons = (failure_value(one, action.parameter, same.__contains__) for one in self._reasons(action.interface))
        return [*reasons, *others[:1]]

    def _arrivals(self, goals: Sequence[Goal], step: int) -> List[Arrival]:
        taken = {one.identifier for one in goals}
        found = [Arrival(GOAL, one) for one in self._repertory.goals if one.arguments[-1] not in taken]
        found += [Arrival(CANCEL, one.term) for one in goals if not one.cancelling]
        return found + [Arrival(FACT, one) for fact in self._repertory.facts for one in self._dated(fact, step)]

    def _dated(self, fact: Symbol, step: int) -> Iterator[Symbol]:
        """Yield a fact of the present cycle, then of earlier and later ones."""
        if self._clock.cycle_of(fact) is None:
            yield fact
            return
        now = self._clock.at_present(fact, step).arguments[-1].number
        for cycle in range(now, max(self._program.first_step, now - self._limits.late) - 1, -1):
            yield redate(fact, cycle)
        for cycle in range(now + 1, now + self._limits.early + 1):
            yield redate(fact, cycle)


class Achievement(NamedTuple):
    """A successful action on the thing of a goal that no later event can have undone.

    Attributes:
        interface: the action's name.
        thing: the last argument of the goal, which is the action's parameter or a part of it.
        resent: whether that goal was sent again afterwards.

    """

    interface: Symbol
    thing: Symbol
    resent: bool = False


Achievements = FrozenSet[Achievement]


def achievements_after(done: Achievements, move: Move, things: Container[Symbol]) -> Achievements:
    """Return the achievements after a move; ``things`` are those of goals.

    Any fact, any action of the same interface and any action on the same thing can undo an achievement, even if the
    action fails.
    """
    if any(one.kind == FACT for one in move.arrivals):
        done = frozenset()
    sent = [one.term.arguments[-1] for one in move.arrivals if one.kind == GOAL]
    done = frozenset(one._replace(resent=True) if one.thing in sent else one for one in done)
    for action, value in move.answers:
        new = Achievement(action.interface, thing_of(action.parameter, things))
        done = frozenset(one for one in done if one.interface != new.interface and one.thing != new.thing)
        if value == action.parameter and new.thing in things:
            done |= {new}
    return done


def thing_of(parameter: Symbol, things: Container[Symbol]) -> Symbol:
    """Return the thing that the parameter is or contains; the parameter itself if there is none, or several.

    For example, ``pair(left,red)`` can contain two things.
    """
    parts = parameter.arguments if parameter not in things and parameter.type is SymbolType.Function else []
    inside = {one for part in parts for one in [thing_of(part, things)] if one in things}
    return inside.pop() if len(inside) == 1 else parameter
