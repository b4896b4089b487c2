"""Translates literals with conditions: spells out pools, names intervals and unnamed variables where they count."""

from typing import Iterable, List, Optional, Sequence, Set, Tuple

from rosoclingo.oclingo.gringo3.lexer import RefusalError, Token
from rosoclingo.oclingo.gringo3.syntax import (
    Element,
    Function,
    Interval,
    Literal,
    Symbol,
    Term,
    Variable,
    alternative_count,
    alternatives,
    has_interval,
    has_pool,
    literal_alternatives,
    literal_terms,
    parts,
    replace_in_literal,
    show,
    show_literal,
    variables,
)

MAXIMAL_ALTERNATIVES = 10000
"""How many literals one literal with pools may stand for."""


class Naming:
    """Hands out variables that occur nowhere in a text."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken: Set[str] = set(taken)
        self._count = 0

    def fresh(self) -> Variable:
        """A variable that was neither in the text nor handed out before."""
        self._count += 1
        name = f"V{self._count}"
        return self.fresh() if name in self._taken else Variable(name)


class ElementTranslator:
    """Translates the elements of one statement."""

    def __init__(self, tokens: Sequence[Token], naming: Naming) -> None:
        self._tokens, self._naming = tokens, naming

    def spelt_out(self, literal: Literal) -> List[Literal]:
        """The literals that a literal with pools stands for; :class:`RefusalError` if there are too many."""
        count = 1
        for term in literal_terms(literal):
            count *= alternative_count(term)
        if count > MAXIMAL_ALTERNATIVES:
            raise RefusalError(
                self._tokens[literal.span[0]], f"this pool stands for more than {MAXIMAL_ALTERNATIVES} literals"
            )
        return literal_alternatives(literal)

    def single(self, term: Optional[Term], literal: Literal, what: str) -> Optional[Term]:
        """The term itself; :class:`RefusalError` if it is a pool."""
        if term is not None and has_pool(term):
            raise RefusalError(
                self._tokens[literal.span[0]],
                f"a pool as {what} has no clear meaning",
                "write one literal for each",
            )
        return term

    def conditions(self, element: Element) -> List[Literal]:
        """The conditions of an element with pools spelt out: they all have to hold."""
        return [found for condition in element.conditions for found in self.spelt_out(condition)]

    def elements(self, element: Element) -> List[Element]:
        """One element for each literal that a pool in front of the conditions stands for."""
        conditions = tuple(self.conditions(element))
        self.single(element.weight, element.literal, "weight")
        self.single(element.priority, element.literal, "priority")
        return [
            Element(element.span, literal, conditions, element.weight, element.priority)
            for literal in self.spelt_out(element.literal)
        ]

    def tuples(self, element: Element, in_head: bool) -> List[Element]:
        """Return an element for each tuple of the pools, in heads also for each literal; bodies join the literals."""
        self.single(element.priority, element.literal, "priority")
        heads = [[one] for one in self.spelt_out(element.literal)] if in_head else [self.spelt_out(element.literal)]
        tuples = alternatives(Function("", (element.terms or (),)))
        return [
            Element(
                element.span,
                literals[0],
                (*literals[1:], *self.conditions(element)),
                None,
                element.priority,
                parts(terms),
            )
            for literals in heads
            for terms in tuples
        ]

    def without_intervals(self, element: Element) -> Element:
        """The element with each interval replaced by a variable that a further condition lets range over it."""
        literal, ranges = self._hoisted(element.literal)
        conditions = []
        for condition in element.conditions:
            if condition.operator == "=" and isinstance(condition.right, Interval):
                conditions.append(condition)
                continue
            changed, more = self._hoisted(condition)
            conditions += [changed]
            ranges += more
        return Element(element.span, literal, (*conditions, *ranges), element.weight, element.priority)

    def _hoisted(self, literal: Literal) -> Tuple[Literal, List[Literal]]:
        ranges: List[Literal] = []

        def name(term: Term) -> Term:
            """Return a variable in place of an interval, which its range is kept for, and any other term as it is."""
            if not isinstance(term, Interval):
                return term
            variable = self._naming.fresh()
            ranges.append(Literal(literal.span, variable, operator="=", right=term))
            return variable

        return replace_in_literal(literal, name), ranges

    def named(self, element: Element) -> Element:
        """The element with a name for each unnamed variable, so that all of them can be listed."""

        def name(term: Term) -> Term:
            return self._naming.fresh() if term == Variable("_") else term

        literal = replace_in_literal(element.literal, name)
        conditions = tuple(replace_in_literal(condition, name) for condition in element.conditions)
        return Element(element.span, literal, conditions, element.weight, element.priority)

    def counted(self, element: Element) -> Element:
        """The element as a multiset sees it: every instance of every variable and interval counts by itself."""
        for term in (element.weight, element.priority):
            if term is not None and has_interval(term):
                token = self._tokens[element.span[0]]
                raise RefusalError(
                    token, "an interval as weight or priority has no clear meaning", "use a variable with a condition"
                )
        return self.named(self.without_intervals(element))


def instance_variables(element: Element) -> List[str]:
    """The names of all variables of an element, which tell its instances apart."""
    literals = (element.literal, *element.conditions)
    return variables(term for literal in literals for term in literal_terms(literal))


def weight(element: Element) -> str:
    """The weight of an element, 1 if none was given."""
    return show(element.weight or Symbol("1"))


def show_conditions(conditions: Sequence[Literal]) -> str:
    """Conditions as today's syntax separates them."""
    return ", ".join(map(show_literal, conditions))


def show_element(element: Element) -> str:
    """A literal with its conditions in today's syntax."""
    if not element.conditions:
        return show_literal(element.literal)
    return f"{show_literal(element.literal)} : {show_conditions(element.conditions)}"
