"""Online progressions as data: stream updates, their statements and sections.

``str()`` of each class is its text in oClingo's language; :mod:`~rosoclingo.oclingo.progression.parser` is the inverse.
"""

from dataclasses import dataclass, field, replace
from typing import ClassVar, FrozenSet, Iterator, Optional, Tuple, Union

import clingo


@dataclass(frozen=True)
class Literal:
    """A ground atom of a body, or its default negation."""

    atom: clingo.Symbol
    positive: bool = True

    def __str__(self) -> str:
        return str(self.atom) if self.positive else f"not {self.atom}"


@dataclass(frozen=True)
class Statement:
    """A ground rule; a fact has no body, an integrity constraint no head."""

    head: Optional[clingo.Symbol]
    body: Tuple[Literal, ...] = ()

    @property
    def atoms(self) -> Tuple[clingo.Symbol, ...]:
        """All atoms of the head and body."""
        head = () if self.head is None else (self.head,)
        return (*head, *(literal.atom for literal in self.body))

    @property
    def subject(self) -> Optional[clingo.Symbol]:
        """The atom that this statement defines or commits to."""
        return self.body[0].atom if self.is_commitment else self.head

    @property
    def is_commitment(self) -> bool:
        """Whether this is a commitment: ``:- not A.``"""
        return self.head is None and len(self.body) == 1 and not self.body[0].positive

    @property
    def is_tautology(self) -> bool:
        """Whether this is ``A :- A, ...``, which has no effect."""
        return self.head is not None and Literal(self.head) in self.body

    def __str__(self) -> str:
        body = ", ".join(map(str, self.body))
        if self.head is None:
            return f":- {body}."
        return f"{self.head} :- {body}." if body else f"{self.head}."


def fact(atom: clingo.Symbol) -> Statement:
    """Return the statement ``atom.``."""
    return Statement(atom)


def commitment(atom: clingo.Symbol) -> Statement:
    """Return the statement ``:- not atom.``: each answer contains ``atom``."""
    return Statement(None, (Literal(atom, positive=False),))


class Directive:
    """A directive; ``form`` is its text with the values of its attributes."""

    form: ClassVar[str]

    def __str__(self) -> str:
        return self.form.format(self)


@dataclass(frozen=True)
class Cumulative(Directive):
    """Section ``#cumulative.``: its statements never lapse."""

    form = "#cumulative."


@dataclass(frozen=True)
class Volatile(Directive):
    """Section ``#volatile.`` or ``#volatile : n.``

    Its statements hold until the next update or, with a window n > 0, while horizon <= step + n - 1.
    """

    window: Optional[int] = None

    def __str__(self) -> str:
        return "#volatile." if self.window is None else f"#volatile : {self.window}."


@dataclass(frozen=True)
class Assert(Directive):
    """Section ``#assert : term.``: its statements hold until the term is retracted."""

    term: clingo.Symbol
    form = "#assert : {0.term}."


@dataclass(frozen=True)
class Retract(Directive):
    """``#retract : term.``: retracts the statements asserted under the term."""

    term: clingo.Symbol
    form = "#retract : {0.term}."


@dataclass(frozen=True)
class StepRange(Directive):
    """A directive about the steps ``first`` to ``last``."""

    first: int
    last: int

    @property
    def range(self) -> str:
        """The steps as text: ``i`` or ``i..j``."""
        return str(self.first) if self.first == self.last else f"{self.first}..{self.last}"


class Forget(StepRange):
    """``#forget i.`` or ``#forget i..j.``: closes the undefined externals declared at these steps."""

    form = "#forget {0.range}."


class CloseCycles(StepRange):
    """``#closed i.`` or ``#closed i..j.``: executed cycles of a plan; an extension of oClingo's language.

    These cycles have no actions except the commitments of the same update (``:- not A.``).
    """

    form = "#closed {0.range}."


@dataclass(frozen=True)
class Expire(Directive):
    """``#over i.``: the steps before i get no further facts, and their externals are closed."""

    step: int
    form = "#over {0.step}."


@dataclass(frozen=True)
class Withdraw(Directive):
    """``#withdraw atom.``: treats a fact, or the commitment to an action, as never asserted."""

    atom: clingo.Symbol
    form = "#withdraw {0.atom}."


@dataclass(frozen=True)
class Reset(Directive):
    """``#anew.``: discards all earlier updates."""

    form = "#anew."


@dataclass(frozen=True)
class Stop(Directive):
    """``#stop.``: ends the solver."""

    form = "#stop."


Section = Union[Cumulative, Volatile, Assert]
Item = Union[Statement, Section, Retract, Forget, CloseCycles, Expire, Withdraw, Reset, Stop]


@dataclass(frozen=True)
class StreamUpdate:
    """One stream update, ``#step k : m.`` ... ``#end step.``

    Attributes:
        step: logical time point k; None keeps the step of the previous update.
        bound: m; the horizon can grow to k + m. None: no bound or, without a step, the previous bound.
        items: statements and directives, in order; a statement belongs to the last section before it, initially
            ``#cumulative.``
        warnings: warnings about text that the parser ignored; not compared.

    """

    step: Optional[int] = None
    bound: Optional[int] = None
    items: Tuple[Item, ...] = ()
    warnings: Tuple[str, ...] = field(default=(), compare=False)

    @property
    def stops(self) -> bool:
        """Whether the update ends the solver."""
        return any(isinstance(item, Stop) for item in self.items)

    def sections(self) -> Iterator[Tuple[Section, Statement]]:
        """Yield every statement with its section."""
        section: Section = Cumulative()
        for item in self.items:
            if isinstance(item, (Cumulative, Volatile, Assert)):
                section = item
            elif isinstance(item, Statement):
                yield section, item

    @property
    def heads(self) -> FrozenSet[Optional[clingo.Symbol]]:
        """The heads of the update's statements; None stands for constraints."""
        return frozenset(statement.head for _, statement in self.sections())

    @property
    def committed(self) -> FrozenSet[clingo.Symbol]:
        """The atoms of the commitments."""
        return frozenset(one.body[0].atom for _, one in self.sections() if one.is_commitment)

    @property
    def withdrawn(self) -> FrozenSet[clingo.Symbol]:
        """The atoms of ``#withdraw``."""
        return frozenset(item.atom for item in self.items if isinstance(item, Withdraw))

    @property
    def plain(self) -> "StreamUpdate":
        """The update without its bound, ``#closed`` and ``#over``."""
        return replace(
            self, bound=None, items=tuple(one for one in self.items if not isinstance(one, (CloseCycles, Expire)))
        )

    def without_facts(self, facts: FrozenSet[clingo.Symbol]) -> "StreamUpdate":
        """Return the update without definitions of, and commitments to, ``facts``."""
        kept = (item for item in self.items if not (isinstance(item, Statement) and item.subject in facts))
        return replace(self, items=tuple(kept))

    def __str__(self) -> str:
        lines = [str(item) for item in self.items]
        if self.step is not None:
            bound = "" if self.bound is None else f" : {self.bound}"
            lines.insert(0, f"#step {self.step}{bound}.")
        return "".join(line + "\n" for line in lines) + "#end step.\n"
