"""Terms, literals and elements of gringo 3: shown in clingo 5's syntax, pools spelled out, intervals and _ named."""

import itertools
import math
from typing import Callable, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple, Union

from rosoclingo.oclingo.grammars import SyntaxNode, Token
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError

MAXIMAL_ALTERNATIVES = 10000
"""How many literals one literal with pools may stand for."""

_TODAY = {":=": "=", "#mod": "\\", "#div": "/", "#pow": "**", ";;": ";"}


def show(one: Union[SyntaxNode, Token]) -> str:
    """A term or a literal in clingo 5's syntax; pools keep their meaning of alternatives."""
    if not isinstance(one, SyntaxNode):
        return _TODAY.get(one, str(one))
    if one.kind == "absolute":
        return f"|{show(one.parts[0])}|"
    if one.kind == "call":
        left, right = (f"({show(part)})" if part.kind in _COMPOSED else show(part) for part in one.parts)
        return f"({left}{show(one.tokens[0])}{right})"
    if one.kind == "function":
        several = len(one.parts) > 1
        return "".join(
            _show_list(child, several) if isinstance(child, SyntaxNode) else show(child) for child in one.children
        )
    return (" " if one.kind in ("literal", "comparison") else "").join(map(show, one.children))


_COMPOSED = ("operation", "signed", "interval", "pool")


def _show_list(arguments: SyntaxNode, among_lists: bool) -> str:
    """Arguments; a pool in one of several gets parentheses, since today's ``;`` separates whole lists of arguments."""
    enclose = len(arguments.parts) > 1 or among_lists
    shown = (f"({show(one)})" if enclose and is_pool(one) else show(one) for one in arguments.children)
    return "".join(shown)


def is_pool(one: Union[SyntaxNode, Token]) -> bool:
    """Whether it is a pool written with ``;``."""
    return isinstance(one, SyntaxNode) and one.kind == "pool"


def has_pool(term: SyntaxNode) -> bool:
    """Whether a term or literal stands for several, written with ``;`` or ``;;``."""
    return any(is_pool(part) or (part.kind == "function" and len(part.parts) > 1) for part in term.walk())


def has_interval(term: SyntaxNode) -> bool:
    """Whether a term or literal holds an interval."""
    return any(part.kind == "interval" for part in term.walk())


def variables(nodes: Iterable[SyntaxNode]) -> List[str]:
    """The names of the variables, each once, in the order of the text; anonymous ones are left out."""
    names = (part.text for node in nodes for part in node.walk() if part.kind == "variable")
    return [name for name in dict.fromkeys(names) if name != "_"]


Domains = Sequence[Tuple[str, Sequence[str]]]
"""Atoms declared by ``#domain``, each with its variables."""


def domain_atoms(names: Iterable[str], domains: Domains) -> List[str]:
    """The atoms of those declarations that one of the variables belongs to."""
    return [atom for atom, own in domains if not set(names).isdisjoint(own)]


def _rebuilt(node: SyntaxNode, children: Sequence[Union[SyntaxNode, Token]]) -> SyntaxNode:
    return SyntaxNode(node.data, list(children))


def replace(node: SyntaxNode, change: Callable[[SyntaxNode], SyntaxNode]) -> SyntaxNode:
    """The node with every node in it replaced by what the function makes of it, from the inside out."""
    return change(
        _rebuilt(node, [replace(one, change) if isinstance(one, SyntaxNode) else one for one in node.children])
    )


def _alternatives(node: SyntaxNode) -> List[SyntaxNode]:
    """The terms or literals that one with pools stands for: every combination of the options."""
    if not has_pool(node):
        return [node]
    options = node.parts if is_pool(node) else []
    if node.kind == "function" and len(node.parts) > 1:
        first = next(n for n, one in enumerate(node.children) if isinstance(one, SyntaxNode))
        options = [_rebuilt(node, [*node.children[:first], one, node.children[-1]]) for one in node.parts]
    if options:
        return [found for one in options for found in _alternatives(one)]
    ways: List[Sequence[Union[SyntaxNode, Token]]]
    ways = [_alternatives(one) if isinstance(one, SyntaxNode) else [one] for one in node.children]
    return [_rebuilt(node, children) for children in itertools.product(*ways)]


def _count(node: SyntaxNode) -> int:
    counts = map(_count, node.parts)
    return sum(counts) if is_pool(node) or (node.kind == "function" and node.parts) else math.prod(counts)


def alternatives(node: SyntaxNode) -> List[SyntaxNode]:
    """The terms or literals that one with pools stands for; :class:`UntranslatableError` if there are too many."""
    if _count(node) > MAXIMAL_ALTERNATIVES:
        raise UntranslatableError(node, f"this pool stands for more than {MAXIMAL_ALTERNATIVES} literals")
    return _alternatives(node)


class Naming:
    """Hands out variables that occur nowhere in a text."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken: Set[str] = set(taken)
        self._count = 0

    def fresh(self) -> SyntaxNode:
        """A variable that was neither in the text nor handed out before."""
        self._count += 1
        name = f"V{self._count}"
        return self.fresh() if name in self._taken else SyntaxNode("variable", [Token("VARIABLE", name)])


class Element(NamedTuple):
    """A literal with conditions, and in multisets and optimization statements with a weight and a priority.

    ``terms`` is the tuple of ``<terms> : literal``; None where there is none.
    """

    place: SyntaxNode
    literal: SyntaxNode
    conditions: Tuple[SyntaxNode, ...] = ()
    weight: Optional[SyntaxNode] = None
    priority: Optional[SyntaxNode] = None
    terms: Optional[Tuple[SyntaxNode, ...]] = None

    @classmethod
    def of(cls, node: SyntaxNode) -> "Element":
        """Return the parts of an element of the text."""
        literals = [part for part in node.parts if part.kind in ("literal", "comparison")]
        kinds = {part.kind: part for part in node.parts}
        terms = tuple(kinds["tuple_terms"].parts) if "tuple_terms" in kinds else ()
        weight, priority = (kinds[kind].parts[0] if kind in kinds else None for kind in ("weight", "priority"))
        literal, *conditions = literals or [SyntaxNode("literal", [Token("BOOLEAN", "#true")])]
        angled = node.children[0] == "<"
        return cls(node, literal, tuple(conditions), weight, priority, terms if angled else None)

    @property
    def literals(self) -> Tuple[SyntaxNode, ...]:
        """The literal and its conditions."""
        return (self.literal, *self.conditions)

    @property
    def shown_weight(self) -> str:
        """The weight, 1 if none was given."""
        return show(self.weight) if self.weight else "1"

    def __str__(self) -> str:
        behind = f" : {', '.join(map(show, self.conditions))}" if self.conditions else ""
        return show(self.literal) + behind

    def _spelt_out(self) -> Tuple[SyntaxNode, ...]:
        """The conditions with pools spelt out: they all have to hold."""
        return tuple(found for condition in self.conditions for found in alternatives(condition))

    def singles(self) -> List["Element"]:
        """One element for each literal that a pool in front of the conditions stands for."""
        check_single(self.place, self.weight, "weight")
        check_single(self.place, self.priority, "priority")
        conditions = self._spelt_out()
        return [self._replace(literal=literal, conditions=conditions) for literal in alternatives(self.literal)]

    def tuples(self, in_head: bool) -> List["Element"]:
        """Return an element for each tuple of the pools, in heads also for each literal; bodies join the literals."""
        check_single(self.place, self.priority, "priority")
        found = alternatives(self.literal)
        heads, rest = ([[one] for one in found] if in_head else [found]), self._spelt_out()
        ways = list(itertools.product(*map(alternatives, self.terms or ())))
        return [
            self._replace(literal=one, conditions=(*more, *rest), terms=terms) for one, *more in heads for terms in ways
        ]

    def without_intervals(self, naming: Naming) -> "Element":
        """The element with each interval replaced by a variable that a further condition lets range over it."""
        ranges: List[SyntaxNode] = []

        def name(term: SyntaxNode) -> SyntaxNode:
            """Return a variable in place of an interval, which its range is kept for, and any other term as it is."""
            if term.kind != "interval":
                return term
            variable = naming.fresh()
            ranges.append(SyntaxNode("comparison", [variable, Token("EQUAL", "="), term]))
            return variable

        def is_range(one: SyntaxNode) -> bool:
            """Return whether a condition lets a variable range over an interval itself."""
            return one.kind == "comparison" and show(one.tokens[0]) == "=" and one.parts[1].kind == "interval"

        literal = replace(self.literal, name)
        conditions = [one if is_range(one) else replace(one, name) for one in self.conditions]
        return self._replace(literal=literal, conditions=(*conditions, *ranges))

    def named(self, naming: Naming) -> "Element":
        """The element with a name for each unnamed variable, so that all of them can be listed."""

        def name(term: SyntaxNode) -> SyntaxNode:
            return naming.fresh() if term.kind == "variable" and term.text == "_" else term

        literal, *conditions = (replace(one, name) for one in self.literals)
        return self._replace(literal=literal, conditions=tuple(conditions))

    def counted(self, naming: Naming) -> "Element":
        """The element as a multiset sees it: every instance of every variable and interval counts by itself."""
        if any(term is not None and has_interval(term) for term in (self.weight, self.priority)):
            message = "an interval as weight or priority has no clear meaning"
            raise UntranslatableError(self.place, message, "use a variable with a condition")
        return self.without_intervals(naming).named(naming)


def check_single(place: SyntaxNode, term: Optional[SyntaxNode], what: str) -> None:
    """:class:`UntranslatableError` if a term is a pool."""
    if term is not None and has_pool(term):
        mend = "write one rule for each bound" if what == "bound" else "write one literal for each"
        raise UntranslatableError(place, f"a pool as {what} has no clear meaning", mend)
