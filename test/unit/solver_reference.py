"""A reference solver: after each update it solves the accumulated program from scratch, in one grounding.

It is independent of the solver under test. Programs are parts of text with ``t`` for the step.
"""

import re
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Dict, FrozenSet, List, Optional, Set, Tuple

import clingo

from rosoclingo.oclingo.progression.updates import (
    Assert,
    Cumulative,
    Forget,
    Retract,
    Statement,
    StreamUpdate,
    Volatile,
)

Answer = FrozenSet[str]


@dataclass(frozen=True)
class Parts:
    """Rules of a program as text; ``externals`` are templates like ``f(1,t)``, ``opens`` names of arity 2.

    ``free`` are names that the program does not mention, and updates can define. ``forgets`` holds terms like ``t-1``.
    """

    base: Tuple[str, ...]
    cumulative: Tuple[str, ...]
    volatile: Tuple[Tuple[int, str], ...]
    externals: Tuple[str, ...]
    opens: Tuple[str, ...]
    free: Tuple[str, ...] = ()
    forgets: Tuple[str, ...] = ()

    def text(self) -> str:
        lines = ["#base.", *self.base, "#cumulative t.", *(f"#external {e}." for e in self.externals)]
        lines += [f"#external {name}/2." for name in self.opens]
        lines += [f"#forget t : {term}." for term in self.forgets]
        lines += self.cumulative
        for window, rule in self.volatile:
            lines += [f"#volatile t : {window}.", rule]
        return "\n".join([*lines, "#volatile t."]) + "\n"


@dataclass
class Held:
    statement: Statement
    lifetime: object
    waiting: bool = False


@dataclass
class Reference:
    """Plays a stream on a program."""

    parts: Parts
    step: int = 1
    horizon: int = 1
    bound: Optional[int] = None
    held: List[Held] = field(default_factory=list)
    closed: Set[str] = field(default_factory=set)
    forgotten: Set[str] = field(default_factory=set)
    opened: Set[str] = field(default_factory=set)

    def declared(self) -> Dict[str, int]:
        """Return each declared external with the step of its declaration."""
        steps = range(1, self.horizon + 1)
        return {at(template, step): step for step in reversed(steps) for template in self.parts.externals}

    def update(self, update: StreamUpdate) -> Tuple[bool, Set[Answer], int, int]:
        """Return whether there are answers, the answers, the horizon, and the number of ignored rules."""
        ignored = self.begin(update)
        while True:
            answers = self.solve()
            if answers or not self.may_grow():
                return bool(answers), answers, self.horizon, ignored
            self.forget(self.grow())

    def begin(self, update: StreamUpdate) -> int:
        """Accept an update and ground up to its step; return the number of ignored rules."""
        self.held = [one for one in self.held if one.lifetime != "update" and not self.has_passed(one.lifetime)]
        if update.step is not None:
            self.step = update.step
            self.bound = None if update.bound is None else update.step + update.bound
        due: List[Forget] = []
        while self.horizon < self.step:
            due += self.grow()
        ignored = self.take(update)
        self.forget([*due, *(one for one in update.items if isinstance(one, Forget))])
        return ignored

    def may_grow(self) -> bool:
        return self.bound is not None and self.horizon < self.bound

    def has_passed(self, lifetime: object) -> bool:
        """Return whether a window has ended."""
        return isinstance(lifetime, int) and lifetime < self.horizon

    def holds_at(self, first: int, end: int) -> bool:
        """Return whether the horizon is in the range from ``first`` to ``end``, exclusive."""
        return first <= self.horizon < end

    def grow(self) -> List[Forget]:
        """Ground the next step; return the steps to forget."""
        self.horizon += 1
        self.held = [one for one in self.held if not self.has_passed(one.lifetime)]
        for one in self.held:
            if one.waiting and str(one.statement.head) in self.declared():
                one.waiting = False
                self.closed |= {str(one.statement.head)} if one.lifetime == "ever" else set()
        steps = [int(at(term, self.horizon)) for term in self.parts.forgets]
        return [Forget(step, step) for step in steps]

    def take(self, update: StreamUpdate) -> int:
        section, ignored, fresh = Cumulative(), 0, set()
        for item in update.items:
            if isinstance(item, (Cumulative, Volatile, Assert)):
                section = item
            elif isinstance(item, Statement):
                ignored += self.statement(item, self.lifetime(section), fresh)
            elif isinstance(item, Retract):
                self.held = [one for one in self.held if one.lifetime != ("term", item.term)]
        self.closed |= fresh
        return ignored

    def lifetime(self, section: object) -> object:
        if isinstance(section, Cumulative):
            return "ever"
        if isinstance(section, Assert):
            return ("term", section.term)
        return "update" if section.window is None else self.step + section.window - 1

    def statement(self, statement: Statement, lifetime: object, fresh: Set[str]) -> int:
        """Accept a statement; return 1 if it is ignored with a warning."""
        if self.has_passed(lifetime):
            return 0
        head = None if statement.head is None else str(statement.head)
        if head is None:
            self.held.append(Held(statement, lifetime))
            return 0
        is_open = head.split("(")[0] in self.parts.opens + self.parts.free
        if is_open:
            self.opened.add(head)
        if any(one.positive and str(one.atom) == head for one in statement.body):
            return 0  # a tautology has no effect
        if head in fresh or ((is_open or head in self.declared()) and head not in self.closed | self.forgotten):
            self.held.append(Held(statement, lifetime))
            fresh |= {head} if lifetime == "ever" else set()
            return 0
        if not statement.body and any(
            str(one.statement.head) == head and not one.statement.body and one.lifetime == "ever" and not one.waiting
            for one in self.held
        ):
            return 0
        later = {at(template, step) for step in range(self.horizon + 1, 40) for template in self.parts.externals}
        if head in later and head not in self.closed | self.forgotten:
            self.held.append(Held(statement, lifetime, waiting=True))
            return 0
        return 1

    def forget(self, items: List[Forget]) -> None:
        defined = {str(one.statement.head) for one in self.held if not one.waiting}
        for item in items:
            for atom, step in self.declared().items():
                if item.first <= step <= item.last and atom not in defined:
                    self.forgotten.add(atom)

    def solve(self) -> Set[Answer]:
        control = clingo.Control(["0", "-Wnone"])
        control.add("base", [], "\n".join(self.rules()))
        control.ground([("base", [])])
        answers: Set[Answer] = set()
        control.solve(on_model=lambda model: answers.add(frozenset(map(str, model.symbols(shown=True)))))
        return answers

    def rules(self) -> List[str]:
        rules = list(self.parts.base)
        for step in range(1, self.horizon + 1):
            rules += [at(rule, step) for rule in self.parts.cumulative]
            rules += [at(rule, step) for window, rule in self.parts.volatile if self.holds_at(step, step + window)]
        rules += [f"#external {atom}." for atom in set(self.declared()) | self.opened]
        held = (one for one in self.held if not one.waiting)
        rules += [
            str(one.statement)
            for one in held
            if not isinstance(one.lifetime, int) or self.holds_at(0, one.lifetime + 1)
        ]
        return rules


@dataclass
class ShortestReference(Reference):
    """Plays a stream as a planner does: it grounds the steps up to ``horizon`` and returns the shortest answer.

    ``settled`` is the greatest step of all updates, and ``asked`` the horizon of the current search.
    """

    settled: int = 1
    asked: int = 1
    before: Optional["ShortestReference"] = None

    def update(self, update: StreamUpdate) -> Tuple[bool, Set[Answer], int, int]:
        """Return whether there are answers, the answers at the lowest horizon, that horizon, and ignored rules."""
        self.settled = max(self.settled, self.step if update.step is None else update.step)
        ignored = self.begin(update)
        self.before = None
        self.before = deepcopy(self)
        self.asked = self.settled
        while True:
            answers = self.solve()
            if answers or (self.asked == self.horizon and not self.may_grow()):
                return bool(answers), answers, self.asked, ignored
            if self.asked == self.horizon:
                self.forget(self.grow())
            self.asked += 1

    def end_at(self, horizon: int) -> None:
        """Set the horizon at which the solver under test ended a search without an answer."""
        assert self.before is not None
        self.__dict__.update(vars(self.before))
        while self.horizon < horizon:
            self.forget(self.grow())

    def has_passed(self, lifetime: object) -> bool:
        return isinstance(lifetime, int) and lifetime < self.settled

    def holds_at(self, first: int, end: int) -> bool:
        return first <= self.asked < end


def at(text: str, step: int) -> str:
    """Return ``text`` with its parameter ``t``, ``t-1`` or ``t+1`` replaced."""
    return re.sub(r"\bt([+-]1)?\b", lambda match: str(step + int(match.group(1) or 0)), text)
