"""Recursive descent over the rules of gringo 3's language, with their bodies, heads and aggregates."""

from typing import List, Optional, Sequence, Tuple

from rosoclingo.oclingo.gringo3.lexer import Kind, RefusalError
from rosoclingo.oclingo.gringo3.syntax import (
    Aggregate,
    Body,
    BodyItem,
    Disjunction,
    Element,
    Function,
    Head,
    Literal,
    Rule,
    Signed,
    Symbol,
    Term,
    Variable,
    WeakConstraint,
)
from rosoclingo.oclingo.gringo3.term_parser import TermParser

COMPARISONS = ("==", "!=", "<=", ">=", "<", ">")
FUNCTIONS = {
    "#count": "{[",
    "#sum": "[{",
    "#sum+": "[{",
    "#min": "[{",
    "#max": "[{",
    "#avg": "[",
    "#even": "{[",
    "#odd": "{[",
}
BOUND_COMPARISONS = ("==", "<", "<=", ">", ">=")
ASSIGNABLE = ("#count", "#sum", "#sum+", "#min", "#max")
PARITY = ("#even", "#odd")
_TWO_BOUNDS = "compare in one direction on both sides, as 1 <= { a, b } < 3, or write no comparison at all"


class StatementParser(TermParser):
    """The grammar's rules above terms; each method raises :class:`RefusalError` at the token that does not fit."""

    def rule(self) -> Rule:
        """A rule with its dot."""
        head = None if self.at(":-") else self.head()
        arrow = self.accept(":-")
        body = Body() if arrow is None else self.body()
        return Rule(head, arrow, body, self.dot())

    def weak_constraint(self) -> WeakConstraint:
        """Read a weak constraint with its dot, and with its weight and priority if it has them."""
        self.expect(":~")
        body, dot = self.body(), self.dot()
        weight: Term = Symbol("1")
        priority: Term = Symbol("1")
        if self.accept("<") is not None:
            weight = weight if self.at(":") else self.term()
            priority = self.term() if self.accept(":") is not None else priority
            self.expect(">")
        return WeakConstraint(body, dot, weight, priority)

    def dot(self) -> int:
        """The dot that ends a statement; its index."""
        return self.expect(".")

    def head(self) -> Head:
        """An atom, an aggregate, or a disjunction."""
        first = self.index
        aggregate = self._aggregate_at_cursor()
        if aggregate:
            return aggregate
        term = self.term()
        if self._at_aggregate() or self._at_compared_aggregate():
            return self.aggregate(first, lower=term)
        return self._disjunction(first, self._atom(first, term))

    def _disjunction(self, first: int, atom: Literal) -> Head:
        elements = [self._element(atom)]
        while self.accept("|") is not None:
            start = self.index
            elements.append(self._element(self._atom(start, self.term())))
        if len(elements) == 1 and not elements[0].conditions:
            return atom
        return Disjunction((first, self.index), tuple(elements))

    def _element(self, literal: Literal) -> Element:
        conditions = self.conditions()
        return Element((literal.span[0], self.index), literal, conditions)

    def conditions(self) -> Tuple[Literal, ...]:
        """Any number of literals, each after a colon."""
        found = []
        while self.accept(":") is not None:
            found.append(self.literal(assignments=True))
        return tuple(found)

    def body(self) -> Body:
        """Body items separated by commas, up to the dot; there may be none."""
        if self.at("."):
            return Body()
        items, commas = [self.body_item()], []
        while self.at(","):
            commas.append(self.step())
            items.append(self.body_item())
        return Body(tuple(items), tuple(commas))

    def body_item(self) -> BodyItem:
        """A literal, maybe with conditions, or an aggregate."""
        first = self.index
        negated = self.accept("not") is not None
        aggregate = self._aggregate_at_cursor(first, negated)
        if aggregate:
            return aggregate
        if self.at("#true", "#false"):
            return self._with_conditions(self._boolean(first, negated))
        term = self.term()
        if self._at_aggregate() or self._at_compared_aggregate():
            return self.aggregate(first, negated, lower=term)
        if not negated and self.at("=", ":="):
            return self._assignment(first, term)
        return self._with_conditions(self._literal(first, term, negated, assignments=True))

    def _with_conditions(self, literal: Literal) -> BodyItem:
        return self._element(literal) if self.at(":") else literal

    def _assignment(self, first: int, term: Term) -> BodyItem:
        self._check_target(term)
        after_equals = self._tokens[self.index + 1].text
        if after_equals in (*FUNCTIONS, "{", "["):
            if after_equals not in (*ASSIGNABLE, "{", "["):
                raise RefusalError(self._tokens[self.index + 1], f"the value of {after_equals} cannot be assigned")
            self.step()
            return self.aggregate(first, assigned=term)
        return self._with_conditions(self._literal(first, term, False, assignments=True))

    def literal(self, assignments: bool) -> Literal:
        """An atom, a comparison, or, if allowed, an assignment."""
        first = self.index
        negated = self.accept("not") is not None
        if self.at("#true", "#false"):
            return self._boolean(first, negated)
        return self._literal(first, self.term(), negated, assignments)

    def _boolean(self, first: int, negated: bool) -> Literal:
        text = self._tokens[self.step()].text
        return Literal((first, self.index), Symbol(text), negated)

    def _literal(self, first: int, left: Term, negated: bool, assignments: bool) -> Literal:
        allowed = (*COMPARISONS, "=", ":=") if assignments and isinstance(left, Variable) else COMPARISONS
        allowed = (*allowed, ":=") if assignments else allowed
        if negated and self.at(*COMPARISONS):
            raise RefusalError(self.token, "a comparison cannot be negated", "turn the comparison round")
        if negated or not self.at(*allowed):
            return self._atom(first, left, negated)
        operator = self._tokens[self.step()].text
        right = self.term()
        return Literal((first, self.index), left, False, "=" if operator == ":=" else operator, right)

    def _check_target(self, term: Term) -> None:
        if self.at("=") and not isinstance(term, Variable):
            raise RefusalError(self.token, "only a variable can stand before '='", "write '==' or ':='")

    def _atom(self, first: int, term: Term, negated: bool = False) -> Literal:
        inner = term.term if isinstance(term, Signed) and term.operator == "-" else term
        named = isinstance(inner, Function) and inner.name and not inner.comma
        identifier = isinstance(inner, Symbol) and inner.text.strip("_")[:1].islower()
        if not named and not identifier:
            raise self.unexpected("a comparison, since the term before is no atom")
        return Literal((first, self.index), term, negated)

    def _at_aggregate(self) -> bool:
        return self.at("{", "[", *FUNCTIONS)

    def _at_compared_aggregate(self) -> bool:
        return self.at(*BOUND_COMPARISONS) and self._tokens[self.index + 1].text in ("{", "[", *FUNCTIONS)

    def _aggregate_at_cursor(self, first: Optional[int] = None, negated: bool = False) -> Optional[Aggregate]:
        start = self.index if first is None else first
        return self.aggregate(start, negated) if self._at_aggregate() else None

    def aggregate(
        self, first: int, negated: bool = False, lower: Optional[Term] = None, assigned: Optional[Term] = None
    ) -> Aggregate:
        """Read an aggregate, from its comparison, function's name or opening bracket to its upper bound."""
        before = self._tokens[self.step()].text if self.at(*BOUND_COMPARISONS) else ""
        start = self.index
        name = self._tokens[self.step()].text if self.at(*FUNCTIONS) else ""
        bracket = self._bracket(name)
        opening = self.index
        elements, commas = self.elements(bracket)
        inside = (opening, self.index)
        self._check_elements(name, bracket, elements)
        parity = name in PARITY
        if parity and (lower is not None or self.at(*BOUND_COMPARISONS)):
            raise RefusalError(self._tokens[start], f"{name} takes no bounds")
        after, upper = self._upper(lower, before) if assigned is None and not parity else ("", None)
        if name == "#avg" and not {before, after}.isdisjoint({"<", ">"}):
            raise RefusalError(self._tokens[start], "'<' and '>' next to an average cannot be translated", "write '<='")
        return Aggregate(
            (first, self.index), start, inside, name or ("#count" if bracket == "{" else "#sum"), elements, commas,
            negated, lower, upper, assigned, bracket, before, after,
        )  # fmt: skip

    def _check_elements(self, name: str, bracket: str, elements: Sequence[Element]) -> None:
        """Raise :class:`RefusalError` at an element that this function does not have in these brackets."""
        for element in elements:
            token, angled = self._tokens[element.span[0]], element.terms is not None
            if angled and name in PARITY:
                raise RefusalError(token, f"{name} takes no tuples")
            if name == "#count" and element.weight is not None:
                raise RefusalError(token, "#count takes no weights", "use #sum")
            if bracket == "{" and name not in ("", "#count", *PARITY) and not element.terms:
                raise RefusalError(
                    token, f"{name} {{ .. }} takes tuples", f"write <weight> : literal, or {name} [ .. ]"
                )

    def _upper(self, lower: Optional[Term], before: str) -> Tuple[str, Optional[Term]]:
        """Read the comparison and the bound behind an aggregate, each if there is one."""
        token = self.token
        if self.at(*BOUND_COMPARISONS):
            after = self._tokens[self.step()].text
            directions = ({"<", "<="}, {">", ">="})
            if lower is not None and not any({before, after} <= one for one in directions):
                raise RefusalError(token, "these bounds do not fit together", _TWO_BOUNDS)
            return after, self.term()
        if self._at_term() and before:
            raise RefusalError(token, "these bounds do not fit together", _TWO_BOUNDS)
        return "", self.term() if self._at_term() else None

    def _bracket(self, name: str) -> str:
        allowed = FUNCTIONS.get(name, "{[")
        if not self.at(*allowed):
            raise self.unexpected(" or ".join(f"'{bracket}'" for bracket in allowed))
        return self.token.text

    def elements(self, bracket: str, priorities: bool = False) -> Tuple[Tuple[Element, ...], Tuple[int, ...]]:
        """The elements from the opening brace or bracket to the closing one, and the indices of the commas."""
        closing = "}" if bracket == "{" else "]"
        self.step()
        found: List[Element] = []
        commas: List[int] = []
        while not self.at(closing):
            angled = bracket == "{" and self.at("<")
            found.append(self.angled(priorities) if angled else self.element(bracket == "[", priorities))
            if self.at(","):
                commas.append(self.step())
            elif not self.at(closing):
                raise self.unexpected(f"',' or '{closing}'")
        self.step()
        return tuple(found), tuple(commas)

    def element(self, weighted: bool, priorities: bool) -> Element:
        """A literal with conditions and, where allowed, ``= weight`` and ``@ priority`` before or after them."""
        first = self.index
        literal = self.literal(assignments=False)
        conditions = self.conditions()
        weight = self.term() if weighted and self.accept("=") is not None else None
        priority = self.term() if priorities and self.accept("@") is not None else None
        if not conditions:
            conditions = self.conditions()
        return Element((first, self.index), literal, conditions, weight, priority)

    def angled(self, priorities: bool) -> Element:
        """Read ``<terms> : literal : conditions``; with priorities the literal is optional, else the terms are."""
        first = self.step()
        terms = [] if self.at(">") else [self.term()]
        while self.accept(",") is not None:
            terms.append(self.term())
        self.expect(">")
        priority = self.term() if priorities and self.accept("@") is not None else None
        conditions = self.conditions()
        if priorities and priority is None and self.accept("@") is not None:
            priority = self.term()
        if not conditions and not priorities:
            raise self.unexpected("':'")
        true = Literal((first, self.index), Symbol("#true"))
        literal, *more = conditions or (true,)
        return Element((first, self.index), literal, tuple(more), None, priority, tuple(terms))

    def _at_term(self) -> bool:
        return self.at("(", "-", "~", "|", "#abs", "#mod", "#div", "#pow", "#infimum", "#supremum", "@") or (
            self.at_kind(Kind.IDENTIFIER, Kind.VARIABLE, Kind.NUMBER, Kind.STRING, Kind.ANONYMOUS)
            and not self.at("not")
        )
