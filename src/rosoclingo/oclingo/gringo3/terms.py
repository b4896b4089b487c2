"""Translation of terms, literals and elements: expansion of pools, variables for intervals and ``_``."""

import itertools
import math
from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple, Union

from rosoclingo.oclingo.grammars import SyntaxNode, Token
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError

MAXIMAL_ALTERNATIVES = 10000
"""Maximum number of literals in the expansion of a literal with pools."""

_HOLDERS = ("list", "pool", "comparison", "weight", "priority")
"""Kinds of nodes whose parts are terms; arithmetic is not among them, as gringo 3 rejects names there."""

_TODAY = {":=": "=", "#mod": "\\", "#div": "/", "#pow": "**", ";;": ";"}


def show(one: Union[SyntaxNode, Token]) -> str:
    """Return a token, term or literal in clingo 5's syntax; pools are not expanded."""
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
    """Return arguments as text; a pool among several arguments needs parentheses in clingo 5."""
    enclose = len(arguments.parts) > 1 or among_lists
    shown = (f"({show(one)})" if enclose and is_pool(one) else show(one) for one in arguments.children)
    return "".join(shown)


def is_pool(one: Union[SyntaxNode, Token]) -> bool:
    """Return whether a node is a pool with ``;``."""
    return isinstance(one, SyntaxNode) and one.kind == "pool"


def has_pool(term: SyntaxNode) -> bool:
    """Return whether a term or literal contains a pool, with ``;`` or ``;;``."""
    return any(is_pool(part) or (part.kind == "function" and len(part.parts) > 1) for part in term.walk())


def has_interval(term: SyntaxNode) -> bool:
    """Return whether a term or literal contains an interval."""
    return any(part.kind == "interval" for part in term.walk())


def variables(nodes: Iterable[SyntaxNode]) -> List[str]:
    """Return the names of all variables except ``_``, without repetitions, in the order of the text."""
    names = (part.text for node in nodes for part in node.walk() if part.kind == "variable")
    return [name for name in dict.fromkeys(names) if name != "_"]


def _rebuilt(node: SyntaxNode, children: Sequence[Union[SyntaxNode, Token]]) -> SyntaxNode:
    return SyntaxNode(node.data, list(children))


def replace(node: SyntaxNode, change: Callable[[SyntaxNode], SyntaxNode]) -> SyntaxNode:
    """Return a copy in which ``change`` has replaced each node, children before their parents."""
    return change(
        _rebuilt(node, [replace(one, change) if isinstance(one, SyntaxNode) else one for one in node.children])
    )


def _alternatives(node: SyntaxNode) -> List[SyntaxNode]:
    """Return the expansion of the pools in a term or literal: every combination of the options."""
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
    """Return the expansion of the pools in a term or literal; raise :class:`UntranslatableError` if it is too large."""
    if _count(node) > MAXIMAL_ALTERNATIVES:
        raise UntranslatableError(node, f"the expansion of this pool has more than {MAXIMAL_ALTERNATIVES} literals")
    return _alternatives(node)


class ProgramScope:
    """The names of a program, and what its earlier statements have declared.

    Attributes:
        domains: the atoms that ``#domain`` declares, each with its variables.
        used: the variables of the earlier statements.
        levels: the number of earlier optimization statements.

    """

    def __init__(self, reserved: Iterable[str]) -> None:
        """Create a scope; ``reserved`` are all variables in the text of the program."""
        self._reserved: Set[str] = set(reserved)
        self._count = 0
        self._terms: Dict[str, str] = {}  # the names that statements use as terms, each with its first place
        self.domains: List[Tuple[str, List[str]]] = []
        self.used: Set[str] = set()
        self.levels = 0

    def fresh(self) -> SyntaxNode:
        """Return a variable that is neither in the text nor the result of an earlier call."""
        self._count += 1
        name = f"V{self._count}"
        return self.fresh() if name in self._reserved else SyntaxNode("variable", [Token("VARIABLE", name)])

    def domains_of(self, names: Iterable[str]) -> List[str]:
        """Return the ``#domain`` atoms that declare one of the variables."""
        return [atom for atom, own in self.domains if not set(names).isdisjoint(own)]

    def note_terms(self, file: str, statement: SyntaxNode) -> None:
        """Record the names that a statement uses as terms outside of arithmetic."""
        for node in statement.walk():
            for part in node.parts if node.kind in _HOLDERS else ():
                if part.kind == "symbol" and part.first.type == "IDENTIFIER":
                    self._terms.setdefault(part.text, f"{file}:{part.line}")

    def define_constant(self, const: SyntaxNode, name: str) -> None:
        """Raise :class:`UntranslatableError` if a statement before a ``#const`` uses its name.

        gringo 3 replaces a constant only in later statements, clingo 5 everywhere.
        """
        if name in self._terms:
            message = f"gringo 3 does not replace '{name}' in the statements before this #const, but clingo 5 does"
            raise UntranslatableError(const, message, f"put the #const before its use in {self._terms[name]}")


class Element(NamedTuple):
    """A literal with conditions; in multisets and optimization statements also with weight and priority.

    ``terms`` is the tuple in ``<terms> : literal``, None without a tuple.
    """

    place: SyntaxNode
    literal: SyntaxNode
    conditions: Tuple[SyntaxNode, ...] = ()
    weight: Optional[SyntaxNode] = None
    priority: Optional[SyntaxNode] = None
    terms: Optional[Tuple[SyntaxNode, ...]] = None

    @classmethod
    def of(cls, node: SyntaxNode) -> "Element":
        """Return the element of a syntax node."""
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
        """The weight as text, 1 by default."""
        return show(self.weight) if self.weight else "1"

    def __str__(self) -> str:
        behind = f" : {', '.join(map(show, self.conditions))}" if self.conditions else ""
        return show(self.literal) + behind

    def _expanded_conditions(self) -> Tuple[SyntaxNode, ...]:
        """Return the conditions with their pools expanded, all of which have to hold."""
        return tuple(found for condition in self.conditions for found in alternatives(condition))

    def singles(self) -> List["Element"]:
        """Return one element for each literal in the expansion of the literal's pools."""
        check_single(self.place, self.weight, "weight")
        check_single(self.place, self.priority, "priority")
        conditions = self._expanded_conditions()
        return [self._replace(literal=literal, conditions=conditions) for literal in alternatives(self.literal)]

    def tuples(self, in_head: bool) -> List["Element"]:
        """Return an element for each expanded tuple; in heads also for each literal, in bodies with all literals."""
        check_single(self.place, self.priority, "priority")
        found = alternatives(self.literal)
        heads, rest = ([[one] for one in found] if in_head else [found]), self._expanded_conditions()
        ways = list(itertools.product(*map(alternatives, self.terms or ())))
        return [
            self._replace(literal=one, conditions=(*more, *rest), terms=terms) for one, *more in heads for terms in ways
        ]

    def without_intervals(self, scope: ProgramScope) -> "Element":
        """Return the element with a variable for each interval and a condition ``variable = interval``."""
        ranges: List[SyntaxNode] = []

        def name(term: SyntaxNode) -> SyntaxNode:
            """Return a variable for an interval and record its range; return other terms unchanged."""
            if term.kind != "interval":
                return term
            variable = scope.fresh()
            ranges.append(SyntaxNode("comparison", [variable, Token("EQUAL", "="), term]))
            return variable

        def is_range(one: SyntaxNode) -> bool:
            """Return whether a condition equates a term and an interval."""
            return one.kind == "comparison" and show(one.tokens[0]) == "=" and one.parts[1].kind == "interval"

        literal = replace(self.literal, name)
        conditions = [one if is_range(one) else replace(one, name) for one in self.conditions]
        return self._replace(literal=literal, conditions=(*conditions, *ranges))

    def named(self, scope: ProgramScope) -> "Element":
        """Return the element with a unique variable for each ``_``."""

        def name(term: SyntaxNode) -> SyntaxNode:
            return scope.fresh() if term.kind == "variable" and term.text == "_" else term

        literal, *conditions = (replace(one, name) for one in self.literals)
        return self._replace(literal=literal, conditions=tuple(conditions))

    def counted(self, scope: ProgramScope) -> "Element":
        """Return the element with variables for intervals and ``_``, so that a multiset counts each instance."""
        if any(term is not None and has_interval(term) for term in (self.weight, self.priority)):
            message = "an interval as weight or priority is ambiguous"
            raise UntranslatableError(self.place, message, "use a variable with a condition")
        return self.without_intervals(scope).named(scope)


def check_single(place: SyntaxNode, term: Optional[SyntaxNode], what: str) -> None:
    """Raise :class:`UntranslatableError` if a term contains a pool."""
    if term is not None and has_pool(term):
        remedy = "write one rule for each bound" if what == "bound" else "write one literal for each option"
        raise UntranslatableError(place, f"a pool as {what} is ambiguous", remedy)
