"""The syntax tree of gringo 3's language: terms, literals, aggregates, statements, and operations on terms.

Nodes are immutable. Literals and what holds them know the range of tokens that they came from, as indices ``(first,
after)`` into the list of tokens, so that a translation can replace them in place. Terms are shown in today's syntax.
"""

import itertools
from dataclasses import dataclass
from typing import Callable, Iterable, Iterator, List, Optional, Sequence, Tuple, Union

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
    """A literal with conditions, and in multisets and optimization statements with a weight and a priority.

    ``terms`` is the tuple of ``<terms> : literal``; None where there is none.
    """

    span: Span
    literal: Literal
    conditions: Tuple[Literal, ...] = ()
    weight: Optional[Term] = None
    priority: Optional[Term] = None
    terms: Optional[Tuple[Term, ...]] = None


@dataclass(frozen=True)
class Aggregate:
    """``lower function{elements} upper``; braces hold sets, brackets multisets of weighted literals.

    ``assigned`` is the term in front of ``=`` or ``:=`` that takes the aggregate's value. ``before`` and ``after`` are
    the comparisons next to ``lower`` and ``upper``, empty for ``<=``. ``inside`` is the span from the opening to the
    closing bracket, ``start`` the token where the function's name or the opening bracket stands; ``commas`` are the
    indices of the tokens between elements.
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
    before: str = ""
    after: str = ""


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


@dataclass(frozen=True)
class WeakConstraint:
    """``:~ body. <weight : priority>``; ``dot`` is the index of its token."""

    body: Body
    dot: int
    weight: Term = Symbol("1")
    priority: Term = Symbol("1")


def show(term: Term) -> str:
    """A term in clingo 5's syntax; pools keep their meaning of alternatives."""
    return _PRINTERS[type(term)](term)


def show_literal(literal: Literal) -> str:
    """A literal in clingo 5's syntax."""
    if literal.right is None:
        return ("not " if literal.negated else "") + show(literal.left)
    return f"{show(literal.left)} {literal.operator} {show(literal.right)}"


def _show_function(term: Function) -> str:
    lists = [_show_arguments(arguments, len(term.lists) > 1) for arguments in term.lists]
    return "{}({}{})".format(term.name, ";".join(lists), "," if term.comma else "")


def _show_arguments(arguments: Sequence[Term], among_lists: bool) -> str:
    """Arguments; a pool in one of several gets parentheses, since today's ``;`` separates whole lists of arguments."""
    enclose = len(arguments) > 1 or among_lists
    return ",".join(f"({show(a)})" if enclose and isinstance(a, Pool) else show(a) for a in arguments)


def _show_operation(term: Operation) -> str:
    rest = (operator + show(operand) for operator, operand in zip(term.operators, term.terms[1:]))
    return show(term.terms[0]) + "".join(rest)


def _show_pool(term: Pool) -> str:
    return ";".join(map(show, term.terms))


_PRINTERS = {
    Symbol: lambda term: term.text,
    Variable: lambda term: term.name,
    Function: _show_function,
    Absolute: lambda term: f"|{show(term.term)}|",
    Signed: lambda term: term.operator + show(term.term),
    Operation: _show_operation,
    Interval: lambda term: f"{show(term.low)}..{show(term.high)}",
    Pool: _show_pool,
}


def parts(term: Term) -> Tuple[Term, ...]:
    """The terms directly inside a term, in the order of the text."""
    if isinstance(term, Function):
        return tuple(itertools.chain.from_iterable(term.lists))
    if isinstance(term, (Absolute, Signed)):
        return (term.term,)
    if isinstance(term, (Operation, Pool)):
        return term.terms
    if isinstance(term, Interval):
        return term.low, term.high
    return ()


def rebuild(term: Term, new: Sequence[Term]) -> Term:
    """The same term with other parts."""
    if isinstance(term, Function):
        rest = iter(new)
        return Function(term.name, tuple(tuple(itertools.islice(rest, len(old))) for old in term.lists), term.comma)
    if isinstance(term, Absolute):
        return Absolute(new[0])
    if isinstance(term, Signed):
        return Signed(term.operator, new[0])
    if isinstance(term, Operation):
        return Operation(tuple(new), term.operators)
    if isinstance(term, Pool):
        return Pool(tuple(new))
    return Interval(new[0], new[1]) if isinstance(term, Interval) else term


def walk(term: Term) -> Iterator[Term]:
    """The term and all terms inside it."""
    yield term
    for part in parts(term):
        yield from walk(part)


def literal_terms(literal: Literal) -> Tuple[Term, ...]:
    """The one or two terms of a literal."""
    return (literal.left,) if literal.right is None else (literal.left, literal.right)


def with_terms(literal: Literal, new: Sequence[Term]) -> Literal:
    """The same literal with other terms."""
    return Literal(literal.span, new[0], literal.negated, literal.operator, None if len(new) == 1 else new[1])


def variables(terms: Iterable[Term]) -> List[str]:
    """The names of the variables in terms, each once, in the order of the text; anonymous ones are left out."""
    names = (part.name for term in terms for part in walk(term) if isinstance(part, Variable))
    return [name for name in dict.fromkeys(names) if name != "_"]


def has_pool(term: Term) -> bool:
    """Whether a term stands for several, written with ``;`` or ``;;``."""
    return any(isinstance(part, Pool) or (isinstance(part, Function) and len(part.lists) > 1) for part in walk(term))


def has_interval(term: Term) -> bool:
    """Whether a term holds an interval."""
    return any(isinstance(part, Interval) for part in walk(term))


def alternatives(term: Term) -> List[Term]:
    """The terms that a term with pools stands for: every combination of the options."""
    if not has_pool(term):
        return [term]
    if isinstance(term, Pool):
        return list(itertools.chain.from_iterable(map(alternatives, term.terms)))
    if isinstance(term, Function) and len(term.lists) > 1:
        single = (Function(term.name, (arguments,), term.comma) for arguments in term.lists)
        return list(itertools.chain.from_iterable(map(alternatives, single)))
    return [rebuild(term, new) for new in itertools.product(*map(alternatives, parts(term)))]


def alternative_count(term: Term) -> int:
    """How many terms a term with pools stands for."""
    if isinstance(term, Pool):
        return sum(map(alternative_count, term.terms))
    if isinstance(term, Function):
        return sum(_product(map(alternative_count, arguments)) for arguments in term.lists)
    return _product(map(alternative_count, parts(term)))


def _product(factors: Iterable[int]) -> int:
    result = 1
    for factor in factors:
        result *= factor
    return result


def literal_alternatives(literal: Literal) -> List[Literal]:
    """The literals that a literal with pools stands for."""
    return [with_terms(literal, new) for new in itertools.product(*map(alternatives, literal_terms(literal)))]


def replace(term: Term, change: Callable[[Term], Term]) -> Term:
    """The term with every part replaced by what the function makes of it, from the inside out."""
    return change(rebuild(term, [replace(part, change) for part in parts(term)]))


def replace_in_literal(literal: Literal, change: Callable[[Term], Term]) -> Literal:
    """The literal with the parts of its terms replaced likewise."""
    return with_terms(literal, [replace(term, change) for term in literal_terms(literal)])
