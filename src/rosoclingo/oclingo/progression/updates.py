"""Online progressions as data: stream updates, their statements and sections, and how they are printed.

``str()`` of everything here is its text in oClingo's language; :mod:`~rosoclingo.oclingo.progression.parser` reads it
back.
"""

from dataclasses import dataclass, field, replace
from typing import FrozenSet, Iterator, Optional, Tuple, Union

import clingo


@dataclass(frozen=True)
class Literal:
    """A ground atom in a body, or its default negation."""

    atom: clingo.Symbol
    positive: bool = True

    def __str__(self) -> str:
        return str(self.atom) if self.positive else f"not {self.atom}"


@dataclass(frozen=True)
class Statement:
    """A ground rule; a fact has no body, an integrity constraint no head."""

    head: Optional[clingo.Symbol]
    body: Tuple[Literal, ...] = ()

    def concerns(self, atoms: FrozenSet[clingo.Symbol]) -> bool:
        """Whether this defines one of ``atoms``, or is the commitment to one."""
        return self.subject in atoms

    @property
    def atoms(self) -> Tuple[clingo.Symbol, ...]:
        """All atoms that it mentions."""
        head = () if self.head is None else (self.head,)
        return (*head, *(literal.atom for literal in self.body))

    @property
    def subject(self) -> Optional[clingo.Symbol]:
        """The atom that this defines or, as a commitment, demands."""
        return self.body[0].atom if self.is_commitment else self.head

    @property
    def is_commitment(self) -> bool:
        """Whether this is ``:- not A.``"""
        return self.head is None and len(self.body) == 1 and not self.body[0].positive

    @property
    def is_tautology(self) -> bool:
        """Whether this is ``A :- A, ...``, which says nothing."""
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
    """Return the statement ``:- not atom.``, by which a plan has to keep ``atom``."""
    return Statement(None, (Literal(atom, positive=False),))


@dataclass(frozen=True)
class Cumulative:
    """Section ``#cumulative.``: its statements hold for ever."""

    def __str__(self) -> str:
        return "#cumulative."


@dataclass(frozen=True)
class Volatile:
    """Section ``#volatile.`` (until the next update) or ``#volatile : n.`` (while horizon <= step + n - 1; 0: none)."""

    window: Optional[int] = None

    def __str__(self) -> str:
        return "#volatile." if self.window is None else f"#volatile : {self.window}."


@dataclass(frozen=True)
class Assert:
    """Section ``#assert : term.``: its statements hold until the term is retracted."""

    term: clingo.Symbol

    def __str__(self) -> str:
        return f"#assert : {self.term}."


@dataclass(frozen=True)
class Retract:
    """``#retract : term.``: ends what was asserted under the term."""

    term: clingo.Symbol

    def __str__(self) -> str:
        return f"#retract : {self.term}."


@dataclass(frozen=True)
class Forget:
    """``#forget i.`` or ``#forget i..j.``: closes the still undefined externals declared at steps first to last."""

    first: int
    last: int

    def __str__(self) -> str:
        return f"#forget {_range(self.first, self.last)}."


def _range(first: int, last: int) -> str:
    return str(first) if first == last else f"{first}..{last}"


@dataclass(frozen=True)
class Closed:
    """``#closed i.`` or ``#closed i..j.``: the past of a plan, which oClingo knew nothing of.

    No answer holds an action of cycles first to last but those that the same update commits to (``:- not A.``).
    """

    first: int
    last: int

    def __str__(self) -> str:
        return f"#closed {_range(self.first, self.last)}."


@dataclass(frozen=True)
class Over:
    """``#over i.``: later updates hold no facts about the steps before i, and their externals are closed."""

    step: int

    def __str__(self) -> str:
        return f"#over {self.step}."


@dataclass(frozen=True)
class Withdraw:
    """``#withdraw atom.``: the fact (or commitment to the action) counts as if it had never been told."""

    atom: clingo.Symbol

    def __str__(self) -> str:
        return f"#withdraw {self.atom}."


@dataclass(frozen=True)
class Anew:
    """``#anew.``: all that was told before this update is forgotten."""

    def __str__(self) -> str:
        return "#anew."


@dataclass(frozen=True)
class Stop:
    """``#stop.``: ends the solver."""

    def __str__(self) -> str:
        return "#stop."


Section = Union[Cumulative, Volatile, Assert]
Item = Union[Statement, Section, Retract, Forget, Closed, Over, Withdraw, Anew, Stop]


@dataclass(frozen=True)
class StreamUpdate:
    """One stream update, ``#step k : m.`` ... ``#end step.``

    Attributes:
        step: logical time point k; None keeps the one of the update before.
        bound: m, by which the horizon may grow beyond k; None is no bound (or, without a step, the one before).
        items: statements and directives, in order; statements belong to the section named last, at first
            ``#cumulative.``
        warnings: what the parser noticed and ignored; no part of the update's value.

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
        """Yield every statement with the section that it stands in."""
        section: Section = Cumulative()
        for item in self.items:
            if isinstance(item, (Cumulative, Volatile, Assert)):
                section = item
            elif isinstance(item, Statement):
                yield section, item

    @property
    def heads(self) -> FrozenSet[Optional[clingo.Symbol]]:
        """The heads of the update's statements; None is that of a constraint."""
        return frozenset(item.head for item in self.items if isinstance(item, Statement))

    @property
    def committed(self) -> FrozenSet[clingo.Symbol]:
        """The atoms that the update commits to."""
        statements = (item for item in self.items if isinstance(item, Statement))
        return frozenset(one.body[0].atom for one in statements if one.is_commitment)

    @property
    def withdrawn(self) -> FrozenSet[clingo.Symbol]:
        """What counts as never told from this update on."""
        return frozenset(item.atom for item in self.items if isinstance(item, Withdraw))

    @property
    def plain(self) -> "StreamUpdate":
        """The update without its bound, and without what it says of cycles that are past: what has happened."""
        return replace(self, bound=None, items=tuple(one for one in self.items if not isinstance(one, (Closed, Over))))

    def less(self, facts: FrozenSet[clingo.Symbol]) -> "StreamUpdate":
        """Return the update without what defines one of ``facts``, and without commitments to them."""
        kept = (item for item in self.items if not (isinstance(item, Statement) and item.concerns(facts)))
        return replace(self, items=tuple(kept))

    def __str__(self) -> str:
        lines = [str(item) for item in self.items]
        if self.step is not None:
            bound = "" if self.bound is None else f" : {self.bound}"
            lines.insert(0, f"#step {self.step}{bound}.")
        return "".join(line + "\n" for line in lines) + "#end step.\n"
