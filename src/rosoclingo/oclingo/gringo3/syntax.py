"""The syntax tree of gringo 3's language: terms, literals, aggregates, statements.

Nodes are immutable. Literals and what holds them know the range of tokens that they came from, as indices ``(first,
after)`` into the list of tokens, so that a translation can replace them in place.
"""

from dataclasses import dataclass
from typing import Optional, Tuple, Union

Span = Tuple[int, int]


@dataclass(frozen=True)
class Symbol:
    """A term without parts: an identifier, a number, a string, ``#infimum``, ``#supremum``."""

    text: str


@dataclass(frozen=True)
class Variable:
    """A variable; ``_`` is the anonymous one."""

    name: str


@dataclass(frozen=True)
class Function:
    """``name(arguments)``, or a tuple or a term in parentheses if the name is empty.

    ``lists`` holds one list of arguments, or several where the text separates them by ``;;``. ``comma`` tells of a
    comma after the last argument, which makes a tuple of one.
    """

    name: str
    lists: Tuple[Tuple["Term", ...], ...]
    comma: bool = False


@dataclass(frozen=True)
class Absolute:
    """``|term|``."""

    term: "Term"


@dataclass(frozen=True)
class Signed:
    """A term after the operator ``-`` or ``~``."""

    operator: str
    term: "Term"


@dataclass(frozen=True)
class Operation:
    """Terms joined by binary operators in today's spelling; precedences are the same in both languages."""

    terms: Tuple["Term", ...]
    operators: Tuple[str, ...]


@dataclass(frozen=True)
class Interval:
    """``low..high``."""

    low: "Term"
    high: "Term"


@dataclass(frozen=True)
class Pool:
    """``first;second;...``."""

    terms: Tuple["Term", ...]


Term = Union[Symbol, Variable, Function, Absolute, Signed, Operation, Interval, Pool]


@dataclass(frozen=True)
class Literal:
    """An atom, maybe negated, or a comparison or an assignment of two terms."""

    span: Span
    left: Term
    negated: bool = False
    operator: str = ""
    right: Optional[Term] = None

    @property
    def is_atom(self) -> bool:
        """Whether it is an atom or a negated atom (or ``#true``, ``#false``)."""
        return self.right is None


@dataclass(frozen=True)
class Element:
    """A literal with conditions, and in multisets and optimization statements with a weight and a priority."""

    span: Span
    literal: Literal
    conditions: Tuple[Literal, ...] = ()
    weight: Optional[Term] = None
    priority: Optional[Term] = None


@dataclass(frozen=True)
class Aggregate:
    """``lower function{elements} upper``; braces hold sets, brackets multisets of weighted literals.

    ``assigned`` is the term in front of ``=`` or ``:=`` that takes the aggregate's value. ``inside`` is the span from
    the opening to the closing bracket, ``start`` the token where the function's name or the opening bracket stands;
    ``commas`` are the indices of the tokens between elements.
    """

    span: Span
    start: int
    inside: Span
    function: str
    elements: Tuple[Element, ...]
    commas: Tuple[int, ...]
    negated: bool = False
    lower: Optional[Term] = None
    upper: Optional[Term] = None
    assigned: Optional[Term] = None
    bracket: str = "{"


BodyItem = Union[Literal, Element, Aggregate]


@dataclass(frozen=True)
class Body:
    """The items of a body and the indices of the commas between them."""

    items: Tuple[BodyItem, ...] = ()
    commas: Tuple[int, ...] = ()


@dataclass(frozen=True)
class Disjunction:
    """A head of several literals with conditions, or of one with a condition."""

    span: Span
    elements: Tuple[Element, ...]


Head = Union[Literal, Disjunction, Aggregate]


@dataclass(frozen=True)
class Rule:
    """A rule, a fact (``arrow`` is None) or a constraint (``head`` is None); ``dot`` and ``arrow`` index tokens."""

    head: Optional[Head]
    arrow: Optional[int]
    body: Body
    dot: int
