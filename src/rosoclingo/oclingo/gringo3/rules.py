"""Translates rules of gringo 3 in place, with their heads, bodies and aggregates.

gringo 3 has sets in braces and multisets in brackets. A set counts each literal once, as today's braces do. A multiset
counts every instance of every element, so that each gets a tuple of its own: weight, the element's number, and all
variables of the element.
"""

from typing import Callable, List, Optional, Sequence

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.grammar import PARITIES, Aggregate, UntranslatableError, aggregate_of
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.terms import (
    Element,
    Naming,
    alternatives,
    check_single,
    has_interval,
    is_pool,
    show,
    variables,
)

_MIRRORED = {"": ">=", "<=": ">=", ">=": "<=", "==": "=="}
"""The comparison of an average with its bound, for each comparison of the bound in front with the average."""


class RuleTranslator:
    """Translates the rules of one file."""

    def __init__(self, rewriting: Rewriting, naming: Naming) -> None:
        self._rewriting, self._naming = rewriting, naming

    def translate(self, rule: SyntaxNode, domains: Sequence[str]) -> None:
        """Translate a rule; ``domains`` are atoms to add to its body."""
        body = next((part for part in rule.parts if part.kind == "body"), None)
        head = next((part for part in rule.parts if part.kind != "body"), None)
        self._body(body)
        if head is not None and head.kind == "aggregate":
            parts = aggregate_of(head)
            if parts.function in (*PARITIES, "#avg"):
                self._several_rules(rule, parts, body, domains)
                return
            self._aggregate(head, in_head=True)
        elif head is not None and head.kind == "disjunction":
            self._disjunction(head)
        elif head is not None and self._rewriting.is_special(head) and not self._plain_pools(head):
            self._rewriting.put(head, show(head))
        self._append(rule, body, domains)

    def weak_body(self, weak: SyntaxNode, domains: Sequence[str]) -> List[str]:
        """Translate the body of a weak constraint; return its variables, which distinguish its instances.

        An unnamed variable or an interval that stands for several instances gets a name.
        """
        body = next((part for part in weak.parts if part.kind == "body"), None)
        self._body(body)
        self._append(weak, body, domains)
        terms: List[SyntaxNode] = []
        for item in body.parts if body else ():
            if item.kind in ("literal", "comparison"):
                terms += self._instances(item)
            elif item.kind != "element":
                parts = aggregate_of(item)
                terms += [term for term in (parts.lower, parts.upper) if term is not None]
        return variables(terms)

    def _instances(self, item: SyntaxNode) -> List[SyntaxNode]:
        found: List[SyntaxNode] = []
        for literal in alternatives(item):
            element = Element(item, literal).without_intervals(self._naming)
            element = element if literal.children[0] == "not" else element.named(self._naming)
            found += element.literals
        if found != [item]:
            self._rewriting.put(item, ", ".join(map(show, found)))
        return found

    def _append(self, rule: SyntaxNode, body: Optional[SyntaxNode], domains: Sequence[str]) -> None:
        if domains:
            start = " " if any(token in (":-", ":~") for token in rule.tokens) else " :- "
            if body:
                start = "; " if body.parts[-1].kind == "element" else ", "
            dot = next(token for token in rule.tokens if token == ".")
            self._rewriting.insert(dot.start_pos or 0, start + ", ".join(domains))

    # ---- bodies and conditions -------------------------------------------------------------------------------------

    def _body(self, body: Optional[SyntaxNode]) -> None:
        for item, comma in zip(body.parts, [*body.tokens, None]) if body else ():
            if item.kind in ("literal", "comparison"):
                if self._rewriting.is_special(item):
                    self._rewriting.put(item, ", ".join(map(show, alternatives(item))))
            elif item.kind != "element":
                self._aggregate(item, in_head=False)
            elif self._needs_text(item):
                self._rewriting.put(item, "; ".join(self._element_texts(item)))
            else:
                self.chain(item)
            if item.kind == "element" and comma is not None:
                self._rewriting.put(comma, ";")

    def chain(self, element: SyntaxNode) -> None:
        """Write the colons between the conditions of an element as commas, in place."""
        for colon in [token for token in element.tokens if token == ":"][1:]:
            self._rewriting.put(colon, ",")

    def _needs_text(self, node: SyntaxNode) -> bool:
        conditions = (one for one in node.parts[1:] if one.kind != "comparison" or one.text not in ("=", ":="))
        return any(map(has_interval, [node.parts[0], *conditions])) or self._rewriting.is_special(node)

    def _element_texts(self, node: SyntaxNode) -> List[str]:
        return [str(single.without_intervals(self._naming)) for single in Element.of(node).singles()]

    def _disjunction(self, head: SyntaxNode) -> None:
        if any(map(self._needs_text, head.parts)):
            texts = [text for element in head.parts for text in self._element_texts(element)]
            self._rewriting.put(head, " | ".join(texts))
        else:
            for element in head.parts:
                self.chain(element)

    def _plain_pools(self, head: SyntaxNode) -> bool:
        """Whether today's syntax reads the atom in the same way: pools are only arguments of their own."""
        if any(token.text in (":=", "#mod", "#div", "#pow", "#abs", ";;") for token in self._rewriting.tokens_of(head)):
            return False
        lists = (part.parts for part in head.walk() if part.kind == "list")
        return not any(len(terms) > 1 and any(map(is_pool, terms)) for terms in lists)

    # ---- aggregates ------------------------------------------------------------------------------------------------

    def _aggregate(self, node: SyntaxNode, in_head: bool) -> None:
        parts, negated = aggregate_of(node), node.kind == "negated"
        if parts.function in PARITIES:
            self._rewriting.put(node, self._parity(parts, not negated))
        elif parts.function == "#avg":
            self._rewriting.put(node, self._average(node, parts, negated))
        else:
            self._bounds(node.parts[-1] if negated else node, parts)
            self._core(parts, in_head)

    def _bounds(self, node: SyntaxNode, parts: Aggregate) -> None:
        check_single(parts.core, parts.lower, "bound")
        check_single(parts.core, parts.upper, "bound")
        lower, upper = parts.lower, parts.upper
        if lower and (self._rewriting.is_special(lower) or parts.before == ":="):
            sign = "=" if parts.assigned else parts.before
            self._rewriting.put(lower, f"{show(lower)} {sign}".rstrip(), node.tokens[0] if sign else lower)
        if upper and self._rewriting.is_special(upper):
            self._rewriting.put(
                node.tokens[-1] if parts.after else upper, f"{parts.after} {show(upper)}".lstrip(), upper
            )

    def _core(self, parts: Aggregate, in_head: bool) -> None:
        core, elements = parts.core, parts.core.parts
        opening, closing = core.tokens[1 if parts.function else 0], core.tokens[-1]
        function = parts.function or ("#count" if parts.is_set else "#sum")
        tuples = any(Element.of(one).terms is not None for one in elements)
        number = 0
        if not parts.is_set:
            apart = self._rewriting.stands_apart(core.span[0])
            self._rewriting.put(core.tokens[0], f"{'' if apart else ' '}{function} {{", opening)
            self._rewriting.put(closing, "}")
        else:
            self._rewriting.put(core.tokens[0], f"{function} {{" if tuples or function != "#count" else "{", opening)
        for node in elements:
            if not parts.is_set:
                singles = Element.of(node).singles()
                texts = [self._weighted(one, str(number + n), in_head) for n, one in enumerate(singles)]
                number += len(singles)
                self._rewriting.put(node, "; ".join(texts))
            elif tuples or function != "#count":
                self._rewriting.put(node, self._tuple_element(Element.of(node), function, in_head))
            else:
                _check_atom(Element.of(node))
                if self._rewriting.is_special(node):
                    self._rewriting.put(node, "; ".join(map(str, Element.of(node).singles())))
                else:
                    self.chain(node)
        separate(self._rewriting, core)

    def _tuple_element(self, element: Element, function: str, in_head: bool) -> str:
        """Return an element of a set of tuples; a counted literal becomes a tuple of its own."""
        if element.terms is None or in_head:
            _check_atom(element)
        if element.terms is None:
            singles = [single.counted(self._naming) for single in element.singles()]
            return "; ".join(_with_tuple(f"0,{instance(one.literal)}", one, in_head) for one in singles)
        mark = ["1"] if function == "#count" else []
        singles = element.tuples(in_head)
        return "; ".join(_with_tuple(",".join([*mark, *map(show, one.terms or ())]), one, in_head) for one in singles)

    def _weighted(self, single: Element, key: str, in_head: bool, change: Callable[[str], str] = str) -> str:
        """An element of a multiset with its own tuple; ``change`` maps the text of the weight."""
        element = single.counted(self._naming)
        if in_head and element.literal.kind == "comparison":
            raise UntranslatableError(element.place, "a comparison in a head cannot be translated")
        terms = ",".join([change(element.shown_weight), key, *variables(element.literals)])
        return _with_tuple(terms, element, in_head)

    def _multiset(self, parts: Aggregate, in_head: bool, change: Callable[[str], str] = str) -> str:
        """All elements of a multiset in one text."""
        singles = [single for node in parts.core.parts for single in Element.of(node).singles()]
        return "; ".join(self._weighted(single, str(key), in_head, change) for key, single in enumerate(singles))

    def _set(self, parts: Aggregate) -> str:
        """All elements as a set, without weights, in one text."""
        elements = [Element.of(node) for node in parts.core.parts]
        for element in elements:
            _check_atom(element)
        return "; ".join(str(single) for element in elements for single in element.singles())

    def _average(self, node: SyntaxNode, parts: Aggregate, negated: bool) -> str:
        sums = self._averages(parts, in_head=False)
        if negated and len(sums) > 1:
            message = "'not' before an average with two bounds cannot be translated"
            raise UntranslatableError(node, message, "write one rule for each bound")
        if negated:
            return "not " + sums[0] if sums else "#false"
        return ", ".join(sums) if sums else "#true"

    def _averages(self, parts: Aggregate, in_head: bool) -> List[str]:
        """The one or two sums that say the same as bounds on an average; none without bounds.

        The average of no weights lies between any bounds, and so does a sum of no differences.
        """
        sums = []
        for bound, relation in ((parts.lower, _MIRRORED[parts.before]), (parts.upper, parts.after or "<=")):
            if bound is not None:
                check_single(parts.core, bound, "bound")
                difference = f"({{}})-({show(bound)})".format
                sums.append(f"#sum {{ {self._multiset(parts, in_head, difference)} }} {relation} 0")
        return sums

    def _parity(self, parts: Aggregate, wanted: bool) -> str:
        """Body literals saying that a parity holds, or not; a fresh variable takes the aggregate's value."""
        value = show(self._naming.fresh())
        aggregate = f"{{ {self._set(parts)} }}" if parts.is_set else f"#sum {{ {self._multiset(parts, False)} }}"
        relation = "=" if (parts.function == "#even") == wanted else "!="
        return f"{value} = {aggregate}, {value} \\ 2 {relation} 0"

    def _several_rules(
        self, rule: SyntaxNode, parts: Aggregate, body: Optional[SyntaxNode], domains: Sequence[str]
    ) -> None:
        text = "; ".join([*([self._rewriting.line(body)] if body else []), *domains])
        behind, choice = (f" :- {text}." if text else "."), f"{{ {self._set(parts)} }}"
        if parts.function == "#avg":
            heads = self._averages(parts, in_head=True) or [choice]
            rules = [head + behind for head in heads]
        else:
            constraint = f":- {text + '; ' if text else ''}{self._parity(parts, False)}."
            rules = [choice + behind, constraint]
        self._rewriting.put(rule, " ".join(rules))


def separate(rewriting: Rewriting, core: SyntaxNode) -> None:
    """Write the commas between the elements in brackets as semicolons, and none behind the last one."""
    for number, comma in enumerate((token for token in core.tokens if token == ","), 1):
        rewriting.put(comma, ";" if number < len(core.parts) else "")


def instance(literal: SyntaxNode) -> str:
    """Return a term that stands for a literal, regardless of its conditions."""
    return f"({int(literal.children[0] == 'not')},{show(literal.parts[0])})"


def _check_atom(element: Element) -> None:
    if element.literal.kind == "comparison":
        message = "a comparison as element of a set cannot be translated"
        raise UntranslatableError(element.literal, message, "write it as a condition, after ':'")


def _with_tuple(terms: str, element: Element, in_head: bool) -> str:
    return f"{terms} : {element if in_head else ', '.join(map(show, element.literals))}"
