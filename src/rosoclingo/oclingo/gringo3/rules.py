"""Translation of rules with their heads, bodies and aggregates.

gringo 3 has sets in braces and multisets in brackets. A set counts each literal once, like braces in clingo 5. A
multiset counts every instance of every element. In clingo 5, each instance therefore has a unique tuple: the weight,
the element's number, and all variables of the element.
"""

from typing import Callable, List, Sequence, Tuple

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.grammar import PARITIES, Aggregate, UntranslatableError, aggregate_of
from rosoclingo.oclingo.gringo3.terms import Element, ProgramScope, alternatives, check_single, show, variables

_MIRRORED = {"": ">=", "<=": ">=", ">=": "<=", "==": "=="}
"""For each relation between a lower bound and an average, the relation between the average and the bound."""


class RuleWriter:
    """Translates rules, their bodies and their aggregates."""

    def __init__(self, scope: ProgramScope) -> None:
        self._scope = scope

    def rule(self, rule: SyntaxNode) -> str:
        """Return the translation of a rule."""
        body = next((part for part in rule.parts if part.kind == "body"), None)
        head = next((part for part in rule.parts if part.kind != "body"), None)
        text = self._joined([self._item(item) for item in (body.parts if body else ())], rule)
        behind = f" :- {text}." if text or ":-" in rule.tokens else "."
        if head is None:
            return behind.strip()
        if head.kind == "aggregate":
            parts = aggregate_of(head)
            if parts.function in (*PARITIES, "#avg"):
                return self._several_rules(parts, text, behind)
            return self._aggregate(head, in_head=True) + behind
        if head.kind == "disjunction":
            return " | ".join(text for element in head.parts for text in self._element_texts(element)) + behind
        return show(head) + behind

    def weak(self, weak: SyntaxNode) -> Tuple[str, List[str]]:
        """Return the translated body of a weak constraint and the variables that distinguish its instances.

        Anonymous variables and intervals that yield several instances are replaced by variables.
        """
        body = next((part for part in weak.parts if part.kind == "body"), None)
        items: List[Tuple[str, bool]] = []
        terms: List[SyntaxNode] = []
        for item in body.parts if body else ():
            if item.kind in ("literal", "comparison"):
                found = self._instances(item)
                terms += found
                items.append((", ".join(map(show, found)), False))
            else:
                items.append(self._item(item))
                parts = aggregate_of(item) if item.kind != "element" else None
                terms += [term for term in (parts.lower, parts.upper) if term is not None] if parts else []
        return self._joined(items, weak), variables(terms)

    def _instances(self, item: SyntaxNode) -> List[SyntaxNode]:
        found: List[SyntaxNode] = []
        for literal in alternatives(item):
            element = Element(item, literal).without_intervals(self._scope)
            found += (element if literal.children[0] == "not" else element.named(self._scope)).literals
        return found

    # ---- bodies and conditions -------------------------------------------------------------------------------------

    def _joined(self, items: Sequence[Tuple[str, bool]], rule: SyntaxNode) -> str:
        """Return a body of items and the domains of the rule's variables; a semicolon ends a condition."""
        items = [*items, *((one, False) for one in self._scope.domains_of(variables([rule])))]
        ends = ["; " if has_condition else ", " for _, has_condition in items[:-1]]
        return "".join(text + end for (text, _), end in zip(items, [*ends, ""]))

    def _item(self, item: SyntaxNode) -> Tuple[str, bool]:
        """Return the translation of a body item, and whether the item has a condition."""
        if item.kind == "element":
            return "; ".join(self._element_texts(item)), True
        if item.kind in ("literal", "comparison"):
            return ", ".join(map(show, alternatives(item))), False
        return self._aggregate(item, in_head=False), False

    def _element_texts(self, node: SyntaxNode) -> List[str]:
        return [str(single.without_intervals(self._scope)) for single in Element.of(node).singles()]

    # ---- aggregates ------------------------------------------------------------------------------------------------

    def _aggregate(self, node: SyntaxNode, in_head: bool) -> str:
        parts, negated = aggregate_of(node), node.kind == "negated"
        if parts.function in PARITIES:
            return self._parity(parts, not negated)
        if parts.function == "#avg":
            return self._average(node, parts, negated)
        check_single(parts.core, parts.lower, "bound")
        check_single(parts.core, parts.upper, "bound")
        before = [show(parts.lower), "=" if parts.assigned else parts.before] if parts.lower else []
        behind = [parts.after, show(parts.upper)] if parts.upper else []
        words = ["not" if negated else "", *before, self._core(parts, in_head), *behind]
        return " ".join(word for word in words if word)

    def _core(self, parts: Aggregate, in_head: bool) -> str:
        elements = [Element.of(one) for one in parts.core.parts]
        if not parts.is_set:
            return f"{parts.function or '#sum'} {{ {self._multiset(parts, in_head)} }}"
        function = parts.function or "#count"
        if function == "#count" and all(one.terms is None for one in elements):
            return f"{{ {self._set(parts)} }}"
        return f"{function} {{ {'; '.join(self._tuple_element(one, function, in_head) for one in elements)} }}"

    def _tuple_element(self, element: Element, function: str, in_head: bool) -> str:
        """Return the translation of an element in a set of tuples; each literal becomes a unique tuple."""
        if element.terms is None or in_head:
            _check_atom(element)
        if element.terms is None:
            singles = [single.counted(self._scope) for single in element.singles()]
            return "; ".join(_with_tuple(f"0,{instance(one.literal)}", one, in_head) for one in singles)
        mark = ["1"] if function == "#count" else []
        singles = element.tuples(in_head)
        return "; ".join(_with_tuple(",".join([*mark, *map(show, one.terms or ())]), one, in_head) for one in singles)

    def _multiset(self, parts: Aggregate, in_head: bool, change: Callable[[str], str] = str) -> str:
        """Return all elements of a multiset with unique tuples; ``change`` maps the texts of the weights."""
        singles = [single for node in parts.core.parts for single in Element.of(node).singles()]
        texts = []
        for key, single in enumerate(singles):
            element = single.counted(self._scope)
            if in_head and element.literal.kind == "comparison":
                raise UntranslatableError(element.place, "a comparison in a head cannot be translated")
            terms = ",".join([change(element.shown_weight), str(key), *variables(element.literals)])
            texts.append(_with_tuple(terms, element, in_head))
        return "; ".join(texts)

    def _set(self, parts: Aggregate) -> str:
        """Return all elements as a set without weights."""
        elements = [Element.of(node) for node in parts.core.parts]
        for element in elements:
            _check_atom(element)
        return "; ".join(str(single) for element in elements for single in element.singles())

    def _average(self, node: SyntaxNode, parts: Aggregate, negated: bool) -> str:
        sums = self._averages(parts, in_head=False)
        if negated and len(sums) > 1:
            message = "'not' before an average with two bounds cannot be translated"
            raise UntranslatableError(node, message, "write one rule for each bound")
        if not sums:
            return "#false" if negated else "#true"
        return ("not " if negated else "") + ", ".join(sums)

    def _averages(self, parts: Aggregate, in_head: bool) -> List[str]:
        """Return the sums that are equivalent to the bounds on an average, one for each bound.

        The average of no weights satisfies any bounds, and so does a sum of no differences.
        """
        sums = []
        for bound, relation in ((parts.lower, _MIRRORED[parts.before]), (parts.upper, parts.after or "<=")):
            if bound is not None:
                check_single(parts.core, bound, "bound")
                difference = f"({{}})-({show(bound)})".format
                sums.append(f"#sum {{ {self._multiset(parts, in_head, difference)} }} {relation} 0")
        return sums

    def _parity(self, parts: Aggregate, wanted: bool) -> str:
        """Return body literals for the parity of an aggregate; for its opposite if ``wanted`` is false."""
        value = show(self._scope.fresh())
        aggregate = f"{{ {self._set(parts)} }}" if parts.is_set else f"#sum {{ {self._multiset(parts, False)} }}"
        relation = "=" if (parts.function == "#even") == wanted else "!="
        return f"{value} = {aggregate}, {value} \\ 2 {relation} 0"

    def _several_rules(self, parts: Aggregate, body: str, behind: str) -> str:
        choice = f"{{ {self._set(parts)} }}"
        if parts.function == "#avg":
            return " ".join(head + behind for head in self._averages(parts, in_head=True) or [choice])
        return f"{choice}{behind} :- {body + '; ' if body else ''}{self._parity(parts, False)}."


def instance(literal: SyntaxNode) -> str:
    """Return a term that represents a literal without its conditions."""
    return f"({int(literal.children[0] == 'not')},{show(literal.parts[0])})"


def _check_atom(element: Element) -> None:
    if element.literal.kind == "comparison":
        message = "a comparison as an element of a set cannot be translated"
        raise UntranslatableError(element.literal, message, "write it as a condition, after ':'")


def _with_tuple(terms: str, element: Element, in_head: bool) -> str:
    return f"{terms} : {element if in_head else ', '.join(map(show, element.literals))}"
