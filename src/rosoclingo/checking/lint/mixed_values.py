"""Rules in which the values of arguments are known only for all values of the first argument together."""

from typing import Dict, Sequence

from rosoclingo.checking.lint.argument_values import ArgumentValues, is_same
from rosoclingo.checking.lint.rule_shapes import Condition, Rule
from rosoclingo.oclingo.progression.terms import Signature


class MixedValues:
    """Finds the rules whose values are not separated by the first argument."""

    def __init__(self, values: ArgumentValues) -> None:
        self._values = values
        self._known: Dict[Signature, bool] = {}

    def mixes(self, rule: Rule) -> bool:
        """Tell whether other arguments of the rule's head can have values that belong to another first argument."""
        first = rule.head.arguments[0]
        naming = [one for one in rule.atoms if any(is_same(argument, first) for argument in one.arguments)]
        known = {first.variable} if first.variable else set()
        fresh = [one for one in naming if is_same(one.arguments[0], first) and self._is_apart(one.signature)]
        while fresh:
            known.update(name for one in fresh for name in one.names)
            fresh = [
                one
                for one in rule.atoms
                if one.arguments and one.arguments[0].variable in known - {""}
                if not one.names <= known and self._is_apart(one.signature)
            ]
        others = {name for argument in rule.head.arguments[1:] for name in argument.names} - known
        return any(_reaches(rule, name, naming, first.variable) for name in others)

    def _is_apart(self, signature: Signature) -> bool:
        """Tell whether the arguments of a predicate are known for each value of its first one."""
        if signature not in self._known:
            self._known[signature] = True  # for rules that need their own head
            rules = [one for one in self._values.rules if one.head.signature == signature]
            self._known[signature] = self._values.is_split(signature) and not any(map(self.mixes, rules))
        return self._known[signature]


def _reaches(rule: Rule, name: str, atoms: Sequence[Condition], but: str) -> bool:
    """Tell whether a variable is joined with one of the atoms by variables other than ``but``."""
    joined, before = {name}, 0
    while before < len(joined):
        before = len(joined)
        joined |= {other for one in rule.atoms if one.names & joined for other in one.names - {but}}
    return any(one.names & joined for one in atoms)
