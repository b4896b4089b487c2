"""What may happen next in a run: goals and cancels come, facts are told, actions return."""

from itertools import combinations, product
from typing import Container, Dict, FrozenSet, Iterable, Iterator, List, Mapping, NamedTuple, Sequence, Tuple

from clingo import Function, Symbol, SymbolType

from rosoclingo.checking.verifying.scope import Limits
from rosoclingo.checking.verifying.shared_solver import retimed
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import parse_term
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import Clock
from rosoclingo.reasoning.keywords import FAILED, Action, Return, failure_value, name_of

FAILURE = Function("failed")
"""A reason that says nothing but that an action was not done."""


class Happening(NamedTuple):
    """Something that comes from outside.

    Attributes:
        kind: ``ask`` for a goal, ``cancel``, or ``tell`` for a fact.
        text: the goal, that which is cancelled, or the fact.

    """

    kind: str
    text: str


class Answer(NamedTuple):
    """How an action ends; ``value`` is its parameter if it was done."""

    action: Action
    value: Symbol

    @property
    def fails(self) -> bool:
        """Whether it is no success."""
        return self.value != self.action.parameter

    @property
    def text(self) -> str:
        """The return as an interface sends it."""
        return str(Return(self.action.interface, self.value, self.action.cycle).atom)


class Move(NamedTuple):
    """What happens before the next update: happenings in order, then the actions under way return."""

    happenings: Tuple[Happening, ...] = ()
    answers: Tuple[Answer, ...] = ()

    @property
    def cost(self) -> int:
        """How many events it counts for: all but what goes as planned."""
        return len(self.happenings) + len(self.failures)

    @property
    def failures(self) -> Tuple[Answer, ...]:
        """The answers that are no success."""
        return tuple(one for one in self.answers if one.fails)


class Repertory(NamedTuple):
    """What may come.

    Attributes:
        goals: what may be asked for.
        facts: what may be told, of the cycle 1.
        reasons: by interface, the values with which an action may return that are no success.

    """

    goals: Tuple[Symbol, ...]
    facts: Tuple[Symbol, ...]
    reasons: Mapping[str, Tuple[Symbol, ...]]


class Moves:
    """All moves of a state."""

    def __init__(self, program: ReactiveProgram, repertory: Repertory, limits: Limits) -> None:
        self._program, self._repertory, self._limits = program, repertory, limits
        self._first = program.first_step
        self._parameters: Dict[Symbol, List[Symbol]] = {}
        self._first_actions: FrozenSet[Tuple[Symbol, Symbol]] = frozenset()  # before any return was known
        self._clock = Clock(program.delay_of, program.first_step)

    def of(self, awaited: Sequence[Action], goals: Sequence[Goal], step: int, due: bool, left: int) -> Iterator[Move]:
        """Yield the moves that count for at most ``left`` events, those with fewer first.

        ``step`` is that of the next update. Where the core waits and is not ``due``, something has to happen.
        """
        happenings = self._happenings(goals, step) if left else []
        for count in range(min(left, self._limits.together) + 1):
            for failing in range(min(count, len(awaited)) + 1):
                for some in combinations(happenings, count - failing):
                    for answers in self._answers(awaited, failing):
                        if awaited or due or some:
                            yield Move(some, answers)

    def returns(self, actions: Iterable[Tuple[Symbol, Symbol]]) -> Iterator[Symbol]:
        """Yield all returns, of cycle 1, of actions, names and parameters, that may be taken."""
        actions = sorted(actions)
        self._first_actions = self._first_actions or frozenset(actions)
        for name, what in actions:
            known = self._parameters.setdefault(name, [])
            known += [] if what in known else [what]
            reasons = self._values(name)
            for value in dict.fromkeys((what, *reasons, *self._clashing(name, what, reasons))):
                yield Return(name, value, 1).atom
                if self._program.declares_external(FAILED, 3):
                    yield Function(FAILED, Return(name, value, 1).atom.arguments)

    def _clashing(self, name: Symbol, what: Symbol, reasons: Sequence[Symbol]) -> Iterator[Symbol]:
        """Yield the values that stand for reasons spelt like a parameter.

        Returns can be parameters of further actions, in programs that take what was done for possible. Values for these
        would give others without end, so only the first actions count.
        """
        own = self._first_actions
        if (name, what) in own:
            for one in reasons:
                yield failure_value(one, what, lambda other: (name, other) in own)

    def _values(self, interface: Symbol) -> Tuple[Symbol, ...]:
        return self._repertory.reasons.get(name_of(interface), (FAILURE,))

    def _answers(self, awaited: Sequence[Action], failing: int) -> Iterator[Tuple[Answer, ...]]:
        for chosen in combinations(range(len(awaited)), failing):
            values = [
                self._failures(one, awaited) if place in chosen else (one.parameter,)
                for place, one in enumerate(awaited)
            ]
            for some in product(*values):
                yield tuple(map(Answer, awaited, some))

    def _failures(self, action: Action, awaited: Sequence[Action]) -> Sequence[Symbol]:
        """Return values that tell of this action that it has failed: reasons, and what another action is about."""
        same = [one.parameter for one in awaited if one.interface == action.interface]
        others = [one for one in self._parameters.get(action.interface, ()) if one not in same]
        reasons = (failure_value(one, action.parameter, same.__contains__) for one in self._values(action.interface))
        return [*reasons, *others[:1]]

    def _happenings(self, goals: Sequence[Goal], step: int) -> List[Happening]:
        taken = {one.identifier for one in goals}
        found = [Happening("ask", str(one)) for one in self._repertory.goals if one.arguments[-1] not in taken]
        found += [Happening("cancel", str(one.term)) for one in goals if not one.cancelling]
        for fact in self._repertory.facts:
            found += [Happening("tell", str(one)) for one in self._dated(fact, step)]
        return found

    def _dated(self, fact: Symbol, step: int) -> Iterator[Symbol]:
        """Yield a fact of the present, of the cycles before it, and of those to come."""
        if self._clock.cycle_of(fact) is None:
            yield fact
            return
        now = self._clock.at_present(fact, step)
        last = now.arguments[-1].number
        for cycle in range(last, max(self._first, last - self._limits.late) - 1, -1):
            yield retimed(fact, cycle)
        for cycle in range(last + 1, last + self._limits.early + 1):
            yield retimed(fact, cycle)


class Deed(NamedTuple):
    """An action about the thing that goals are about, which was done, and of which nothing tells that it was undone.

    Attributes:
        interface: the action's name.
        what: that thing, the last argument of a goal: its parameter, or a part of it.
        again: whether that goal was sent again since.

    """

    interface: Symbol
    what: Symbol
    again: bool = False


Done = FrozenSet[Deed]


def done_after(done: Done, move: Move, things: Container[Symbol]) -> Done:
    """Return what is done after a move, where goals are about ``things``.

    Another action of the same kind, and another kind of action about the same thing, may undo an action, and so may
    its failure; and any fact may tell that it was undone.
    """
    if any(one.kind == "tell" for one in move.happenings):
        done = frozenset()
    asked = [goal_of(one).arguments[-1] for one in move.happenings if one.kind == "ask"]
    done = frozenset(one._replace(again=True) if one.what in asked else one for one in done)
    for action, value in move.answers:
        deed = Deed(action.interface, thing_of(action.parameter, things))
        done = frozenset(one for one in done if one.interface != deed.interface and one.what != deed.what)
        if value == action.parameter and deed.what in things:
            done |= {deed}
    return done


def thing_of(parameter: Symbol, things: Container[Symbol]) -> Symbol:
    """Return which of ``things`` an action with this parameter is about: the parameter, or the one that is part of it.

    Where it is about none or several, as ``pair(left,red)`` may be, that is the parameter itself.
    """
    parts = parameter.arguments if parameter not in things and parameter.type is SymbolType.Function else []
    inside = {one for part in parts for one in [thing_of(part, things)] if one in things}
    return inside.pop() if len(inside) == 1 else parameter


def goal_of(happening: Happening) -> Symbol:
    """Return the goal that is asked for or cancelled."""
    return parse_term(happening.text)
