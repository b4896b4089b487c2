"""Translates ``#minimize``, ``#maximize`` and ``#compute``."""

from typing import Dict, List, Sequence, Tuple

from rosoclingo.oclingo.gringo3.directive_parser import Elements
from rosoclingo.oclingo.gringo3.elements import ElementTranslator, Naming, instance_variables, show_conditions, weight
from rosoclingo.oclingo.gringo3.lexer import Token
from rosoclingo.oclingo.gringo3.rewriter import Rewriting
from rosoclingo.oclingo.gringo3.syntax import Element
from rosoclingo.oclingo.gringo3.term_nodes import show, show_literal

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
            for single in self._elements.elements(element):
                key = f'"{self._file}:{level + 1}"' + ("," + step if step else "")
                key += "" if parsed.bracket == "{" else "," + str(number)
                texts.append(self._element(single, parsed.bracket == "{", key, level, domains))
                number += 1
            self._rewriting.replace(element.span, "; ".join(texts))
        for count, comma in enumerate(parsed.commas, 1):
            self._rewriting.replace((comma, comma + 1), ";" if count < len(parsed.elements) else "")

    def _element(self, element: Element, unique: bool, key: str, level: int, domains: Domains) -> str:
        added = domain_atoms(self._tokens[element.span[0] : element.span[1]], domains)
        element = self._elements.counted(element)
        atom = f"({int(element.literal.negated)},{show(element.literal.left)})"
        instance = [atom] if unique else instance_variables(element)
        priority = show(element.priority) if element.priority else str(level)
        terms = ",".join([f"{weight(element)}@{priority}", key, *instance])
        conditions = show_conditions((element.literal, *element.conditions))
        return "{} : {}".format(terms, ", ".join([conditions, *added]))

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
