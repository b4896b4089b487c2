"""Translates lists of weighted literals: aggregates, ``#minimize``, ``#maximize``, ``#compute``.

gringo 3 has sets in braces and multisets in brackets. A set counts each literal once, as today's braces do. A multiset
counts every instance of every element, so that each gets a tuple of its own: weight, the element's number, and all
variables of the element.
"""

from typing import Callable, Dict, List, Optional, Sequence, Tuple

from rosoclingo.oclingo.gringo3.directive_parser import Elements
from rosoclingo.oclingo.gringo3.elements import (
    ElementTranslator,
    Naming,
    instance_variables,
    show_conditions,
    show_element,
    weight,
)
from rosoclingo.oclingo.gringo3.lexer import RefusalError, Token
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.syntax import (
    Aggregate,
    Element,
    Literal,
    Term,
    WeakConstraint,
    has_interval,
    has_pool,
    show,
    show_literal,
)

SPECIAL = (":=", "#mod", "#div", "#pow", "#abs", ";;", ";")
"""Tokens inside literals and terms that today's syntax lacks or reads otherwise."""

_MIRRORED = {"": ">=", "<=": ">=", ">=": "<=", "==": "=="}
"""The comparison of an average with its bound, for each comparison of the bound in front with the average."""


class AggregateTranslator:
    """Translates aggregates in place; heads and bodies write the elements of a multiset in different ways."""

    def __init__(self, tokens: Sequence[Token], rewriting: Rewriting, naming: Naming) -> None:
        self._tokens, self._rewriting, self._naming = tokens, rewriting, naming
        self.elements = ElementTranslator(tokens, naming)

    def special(self, first: int, after: int) -> bool:
        """Whether a range of tokens holds one that today's syntax lacks or reads otherwise."""
        return any(token.text in SPECIAL for token in self._tokens[first:after])

    def in_place(self, aggregate: Aggregate, in_head: bool) -> None:
        """Translate any aggregate but averages and parities."""
        self._bounds(aggregate)
        first, after = aggregate.inside
        if has_tuples(aggregate) or (aggregate.bracket == "{" and aggregate.function != "#count"):
            self._rewriting.replace((aggregate.start, first + 1), aggregate.function + " {")
            for element in aggregate.elements:
                self._rewriting.replace(element.span, self._tuple_element(element, aggregate.function, in_head))
        elif aggregate.bracket == "{":
            self._rewriting.replace((aggregate.start, first + 1), "{")
            for element in aggregate.elements:
                self._set_element(element)
        else:
            apart = self._tokens[aggregate.start - 1].end < self._tokens[aggregate.start].start or not aggregate.start
            self._rewriting.replace((aggregate.start, first + 1), ("" if apart else " ") + aggregate.function + " {")
            self._rewriting.replace((after - 1, after), "}")
            self._weighted_elements(aggregate, in_head)
        self._separators(aggregate)

    def _separators(self, aggregate: Aggregate) -> None:
        for number, comma in enumerate(aggregate.commas, 1):
            self._rewriting.replace((comma, comma + 1), ";" if number < len(aggregate.elements) else "")

    def _bounds(self, aggregate: Aggregate) -> None:
        for bound in (aggregate.lower, aggregate.upper, aggregate.assigned):
            self._check_bound(aggregate, bound)
        first = aggregate.span[0] + aggregate.negated
        before = aggregate.assigned or aggregate.lower
        if before and self.special(first, aggregate.start):
            sign = "=" if aggregate.assigned else aggregate.before
            self._rewriting.replace((first, aggregate.start), f"{show(before)} {sign}".rstrip())
        if aggregate.upper and self.special(aggregate.inside[1], aggregate.span[1]):
            text = f"{aggregate.after} {show(aggregate.upper)}".lstrip()
            self._rewriting.replace((aggregate.inside[1], aggregate.span[1]), text)

    def _check_bound(self, aggregate: Aggregate, bound: Optional[Term]) -> None:
        if bound and has_pool(bound):
            raise RefusalError(
                self._tokens[aggregate.start], "a pool as bound has no clear meaning", "write one rule for each bound"
            )

    def _tuple_element(self, element: Element, function: str, in_head: bool) -> str:
        """Return an element of a set of tuples; a counted literal becomes a tuple of its own."""
        if element.terms is None:
            self._check_set_literal(element.literal)
            singles = [self.elements.counted(single) for single in self.elements.elements(element)]
            return "; ".join(_with_tuple(f"0,{instance(one.literal)}", one, in_head) for one in singles)
        mark = ["1"] if function == "#count" else []
        singles = self.elements.tuples(element, in_head)
        for one in singles if in_head else ():
            self._check_set_literal(one.literal)
        return "; ".join(_with_tuple(",".join([*mark, *map(show, one.terms or ())]), one, in_head) for one in singles)

    def _set_element(self, element: Element) -> None:
        self._check_set_literal(element.literal)
        if self.special(*element.span):
            self._rewriting.replace(element.span, "; ".join(map(show_element, self.elements.elements(element))))
        else:
            self.chain(element)

    def _check_set_literal(self, literal: Literal) -> None:
        if not literal.is_atom:
            message = "a comparison as element of a set cannot be translated"
            raise RefusalError(self._tokens[literal.span[0]], message, "write it as a condition, after ':'")

    def chain(self, element: Element) -> None:
        """Write the colons between the conditions of an element as commas, in place."""
        for condition in element.conditions[1:]:
            colon = condition.span[0] - 1
            self._rewriting.replace((colon, colon + 1), ",")

    def _weighted_elements(self, aggregate: Aggregate, in_head: bool) -> None:
        number = 0
        for element in aggregate.elements:
            texts = []
            for single in self.elements.elements(element):
                texts.append(self.weighted(single, str(number), in_head))
                number += 1
            self._rewriting.replace(element.span, "; ".join(texts))

    def weighted(self, element: Element, key: str, in_head: bool, change: Callable[[str], str] = str) -> str:
        """An element of a multiset with its own tuple; ``change`` maps the text of the weight."""
        element = self.elements.counted(element)
        literal = element.literal
        if in_head and not literal.is_atom:
            raise RefusalError(self._tokens[literal.span[0]], "a comparison in a head cannot be translated")
        terms = ",".join([change(weight(element)), key, *instance_variables(element)])
        return _with_tuple(terms, element, in_head)

    def tuples(self, aggregate: Aggregate, in_head: bool, change: Callable[[str], str] = str) -> str:
        """All elements of a multiset in one text."""
        singles = [single for element in aggregate.elements for single in self.elements.elements(element)]
        return "; ".join(self.weighted(single, str(key), in_head, change) for key, single in enumerate(singles))

    def literals(self, aggregate: Aggregate) -> str:
        """All elements as a set, without weights, in one text."""
        for element in aggregate.elements:
            self._check_set_literal(element.literal)
        singles = [single for element in aggregate.elements for single in self.elements.elements(element)]
        return "; ".join(map(show_element, singles))

    def averages(self, aggregate: Aggregate, in_head: bool) -> List[str]:
        """The one or two sums that say the same as bounds on an average; none without bounds.

        The average of no weights lies between any bounds, and so does a sum of no differences.
        """
        sums = []
        for bound, relation in (
            (aggregate.lower, _MIRRORED[aggregate.before]),
            (aggregate.upper, aggregate.after or "<="),
        ):
            if bound is None:
                continue
            self._check_bound(aggregate, bound)
            difference = f"({{}})-({show(bound)})".format
            sums.append(f"#sum {{ {self.tuples(aggregate, in_head, difference)} }} {relation} 0")
        return sums

    def parity(self, aggregate: Aggregate, wanted: bool) -> str:
        """Body literals saying that a parity holds, or not; a fresh variable takes the aggregate's value."""
        value = show(self._naming.fresh())
        elements = self.literals(aggregate) if aggregate.bracket == "{" else self.tuples(aggregate, False)
        function = "" if aggregate.bracket == "{" else "#sum "
        relation = "=" if (aggregate.function == "#even") == wanted else "!="
        return f"{value} = {function}{{ {elements} }}, {value} \\ 2 {relation} 0"


def has_tuples(aggregate: Aggregate) -> bool:
    """Tell whether an aggregate has elements such as ``<terms> : literal``."""
    return any(element.terms is not None for element in aggregate.elements)


def instance(literal: Literal) -> str:
    """Return a term that stands for a literal, regardless of its conditions."""
    return f"({int(literal.negated)},{show(literal.left)})"


def _with_tuple(terms: str, element: Element, in_head: bool) -> str:
    if in_head:
        return f"{terms} : {show_element(element)}"
    return f"{terms} : {show_conditions((element.literal, *element.conditions))}"


Domains = Sequence[Tuple[str, Sequence[str]]]
"""Atoms declared by ``#domain``, each with its variables."""


class OptimizationTranslator:
    """Translates the optimization statements of one file.

    Today's solver puts the tuples of all statements of one priority into one set, so each statement gets a mark of its
    own: the file's name and a number.
    """

    def __init__(self, tokens: Sequence[Token], rewriting: Rewriting, naming: Naming, file: str) -> None:
        self._tokens, self._rewriting, self._file = tokens, rewriting, file
        self._elements = ElementTranslator(tokens, naming)
        self._weak_constraints = 0

    def optimize(self, parsed: Elements, level: int, step: str, domains: Domains) -> None:
        """Translate in place.

        ``level`` is the number of optimization statements before this one, ``step`` the parameter of its part, if any.
        """
        first, after = parsed.inside
        self._rewriting.replace((first, first + 1), "{")
        self._rewriting.replace((after - 1, after), "}")
        number = 0
        for element in parsed.elements:
            texts = []
            for single in self._singles(element):
                key = f'"{self._file}:{level + 1}"' + ("," + step if step else "")
                key += "" if parsed.bracket == "{" else "," + str(number)
                texts.append(self._element(single, parsed.bracket == "{", key, level, domains))
                number += 1
            self._rewriting.replace(element.span, "; ".join(texts))
        for count, comma in enumerate(parsed.commas, 1):
            self._rewriting.replace((comma, comma + 1), ";" if count < len(parsed.elements) else "")

    def _singles(self, element: Element) -> List[Element]:
        if element.terms is None:
            return self._elements.elements(element)
        return self._elements.tuples(element, in_head=False)

    def _element(self, element: Element, unique: bool, key: str, level: int, domains: Domains) -> str:
        added = domain_atoms(self._tokens[element.span[0] : element.span[1]], domains)
        priority = show(element.priority) if element.priority else str(level)
        if element.terms is None:
            element = self._elements.counted(element)
            first, rest = weight(element), [instance(element.literal)] if unique else instance_variables(element)
        else:
            first, *rest = map(show, element.terms)
        terms = ",".join([f"{first}@{priority}", key, *rest])
        conditions = show_conditions((element.literal, *element.conditions))
        return "{} : {}".format(terms, ", ".join([conditions, *added]))

    def weak(self, weak: WeakConstraint, after: int, step: str, variables: Sequence[str]) -> None:
        """Write the weight of a weak constraint, whose end is before ``after``; each instance of its body counts."""
        token = self._tokens[weak.dot]
        for term, what in ((weak.weight, "weight"), (weak.priority, "priority")):
            if has_pool(term) or has_interval(term):
                raise RefusalError(token, f"a pool or an interval as {what} of a weak constraint has no clear meaning")
        self._weak_constraints += 1
        terms = [f'"{self._file}:~{self._weak_constraints}"', *([step] if step else []), *variables]
        text = f". [{show(weak.weight)}@{show(weak.priority)},{','.join(terms)}]"
        self._rewriting.replace((weak.dot, after), text)

    def compute(self, first: int, parsed: Elements, domains: Domains) -> None:
        """Replace a ``#compute`` statement by constraints."""
        rules = [rule for element in parsed.elements for rule in self._constraints(element, domains)]
        self._rewriting.replace((first, parsed.dot + 1), " ".join(rules))

    def _constraints(self, element: Element, domains: Domains) -> List[str]:
        added = domain_atoms(self._tokens[element.span[0] : element.span[1]], domains)
        rules = []
        for single in self._elements.elements(element):
            atom = show(single.literal.left)
            wanted = atom if single.literal.negated else "not " + atom
            rules.append(":- {}.".format(", ".join([wanted, *map(show_literal, single.conditions), *added])))
        return rules


def domain_atoms(tokens: Sequence[Token], domains: Domains) -> List[str]:
    """The atoms of those declarations that a variable among the tokens belongs to."""
    names: Dict[str, None] = dict.fromkeys(token.text for token in tokens)
    return [atom for atom, variables in domains if any(variable in names for variable in variables)]
