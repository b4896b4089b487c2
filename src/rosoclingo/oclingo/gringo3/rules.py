"""Translates rules of gringo 3 in place."""

from typing import List, Sequence

from rosoclingo.oclingo.gringo3.aggregates import AggregateTranslator
from rosoclingo.oclingo.gringo3.elements import Naming, show_element
from rosoclingo.oclingo.gringo3.lexer import RefusalError, Token
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.syntax import (
    Aggregate,
    Body,
    BodyItem,
    Disjunction,
    Element,
    Function,
    Head,
    Literal,
    Pool,
    Rule,
    Term,
    has_interval,
    literal_terms,
    show_literal,
    variables,
    walk,
)

PARITIES = ("#even", "#odd")


class RuleTranslator:
    """Translates the rules of one file."""

    def __init__(self, tokens: Sequence[Token], rewriting: Rewriting, naming: Naming) -> None:
        self._tokens, self._rewriting = tokens, rewriting
        self._aggregates = AggregateTranslator(tokens, rewriting, naming)

    def translate(self, first: int, rule: Rule, domains: Sequence[str]) -> None:
        """Translate a rule that starts at a token; ``domains`` are atoms to add to its body."""
        self._body(rule.body)
        if isinstance(rule.head, Aggregate) and rule.head.function in (*PARITIES, "#avg"):
            self._several_rules(first, rule, domains)
            return
        if rule.head is not None:
            self._head(rule.head)
        self._append(rule, domains)

    def weak_body(self, body: Body, dot: int, domains: Sequence[str]) -> List[str]:
        """Translate the body of a weak constraint; return its variables, which distinguish its instances.

        An unnamed variable or an interval that stands for several instances gets a name.
        """
        self._body(body)
        self._append(Rule(None, dot, body, dot), domains)
        terms: List[Term] = []
        for item in body.items:
            if isinstance(item, Literal):
                literals = self._instances(item)
                terms += [term for literal in literals for term in literal_terms(literal)]
            elif isinstance(item, Aggregate):
                terms += [term for term in (item.assigned, item.lower, item.upper) if term is not None]
        return variables(terms)

    def _instances(self, item: Literal) -> List[Literal]:
        found: List[Literal] = []
        for literal in self._aggregates.elements.spelt_out(item):
            element = self._aggregates.elements.without_intervals(Element(item.span, literal))
            element = element if literal.negated else self._aggregates.elements.named(element)
            found += [element.literal, *element.conditions]
        if found != [item]:
            self._rewriting.replace(item.span, ", ".join(map(show_literal, found)))
        return found

    def special(self, first: int, after: int) -> bool:
        """Whether a range of tokens holds one that today's syntax lacks or reads otherwise."""
        return self._aggregates.special(first, after)

    def chain(self, element: Element) -> None:
        """Write the colons between the conditions of an element as commas, in place."""
        self._aggregates.chain(element)

    def _append(self, rule: Rule, domains: Sequence[str]) -> None:
        if domains:
            start = " :- " if rule.arrow is None else self._joint(rule) if rule.body.items else " "
            self._rewriting.insert(rule.dot, start + ", ".join(domains))

    def _joint(self, rule: Rule) -> str:
        return "; " if isinstance(rule.body.items[-1], Element) else ", "

    def _body(self, body: Body) -> None:
        for number, item in enumerate(body.items):
            self._item(item)
            if isinstance(item, Element) and number < len(body.commas):
                comma = body.commas[number]
                self._rewriting.replace((comma, comma + 1), ";")

    def _item(self, item: BodyItem) -> None:
        if isinstance(item, Literal):
            if self._aggregates.special(*item.span):
                literals = self._aggregates.elements.spelt_out(item)
                self._rewriting.replace(item.span, ", ".join(map(show_literal, literals)))
        elif isinstance(item, Element):
            self._conditional(item)
        elif item.function in PARITIES:
            self._rewriting.replace(item.span, self._aggregates.parity(item, not item.negated))
        elif item.function == "#avg":
            self._rewriting.replace(item.span, self._average(item))
        else:
            self._aggregates.in_place(item, in_head=False)

    def _average(self, item: Aggregate) -> str:
        sums = self._aggregates.averages(item, in_head=False)
        if item.negated and len(sums) > 1:
            token = self._tokens[item.span[0]]
            raise RefusalError(
                token, "'not' before an average with two bounds cannot be translated", "write one rule for each bound"
            )
        if item.negated:
            return "not " + sums[0] if sums else "#false"
        return ", ".join(sums) if sums else "#true"

    def _conditional(self, item: Element) -> None:
        if self._needs_text(item):
            self._rewriting.replace(item.span, "; ".join(self._element_texts(item)))
        else:
            self._aggregates.chain(item)

    def _needs_text(self, element: Element) -> bool:
        literals = (element.literal, *(c for c in element.conditions if c.operator != "="))
        intervals = any(has_interval(term) for literal in literals for term in literal_terms(literal))
        return intervals or self._aggregates.special(*element.span)

    def _element_texts(self, element: Element) -> List[str]:
        translator = self._aggregates.elements
        return [show_element(translator.without_intervals(single)) for single in translator.elements(element)]

    def _head(self, head: Head) -> None:
        if isinstance(head, Aggregate):
            self._aggregates.in_place(head, in_head=True)
        elif isinstance(head, Disjunction):
            self._disjunction(head)
        elif self._aggregates.special(*head.span) and not self._plain_pools(head):
            self._rewriting.replace(head.span, show_literal(head))

    def _plain_pools(self, head: Literal) -> bool:
        """Whether today's syntax reads the atom in the same way: pools are only arguments of their own."""
        marks = {token.text for token in self._tokens[head.span[0] : head.span[1]]}
        if marks & {":=", "#mod", "#div", "#pow", "#abs", ";;"}:
            return False
        functions = (part for part in walk(head.left) if isinstance(part, Function))
        return not any(
            isinstance(term, Pool) for f in functions for terms in f.lists if len(terms) > 1 for term in terms
        )

    def _disjunction(self, head: Disjunction) -> None:
        if any(map(self._needs_text, head.elements)):
            texts = [text for element in head.elements for text in self._element_texts(element)]
            self._rewriting.replace(head.span, " | ".join(texts))
        else:
            for element in head.elements:
                self._aggregates.chain(element)

    def _several_rules(self, first: int, rule: Rule, domains: Sequence[str]) -> None:
        head, body = rule.head, self._body_text(rule, domains)
        assert isinstance(head, Aggregate)
        if head.function == "#avg":
            heads = self._aggregates.averages(head, in_head=True) or [f"{{ {self._aggregates.literals(head)} }}"]
            rules = [text + (" :- " + body if body else "") + "." for text in heads]
        else:
            choice = f"{{ {self._aggregates.literals(head)} }}" + (" :- " + body if body else "") + "."
            rules = [choice, ":- {}{}.".format(body + "; " if body else "", self._aggregates.parity(head, False))]
        self._rewriting.replace((first, rule.dot + 1), " ".join(rules))

    def _body_text(self, rule: Rule, domains: Sequence[str]) -> str:
        items = rule.body.items
        text = self._rewriting.line((items[0].span[0], items[-1].span[1])) if items else ""
        return "; ".join([*([text] if text else []), *domains])
