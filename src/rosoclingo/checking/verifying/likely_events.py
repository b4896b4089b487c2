"""Derives the likely events of a program from its rules: goals, facts, and the reasons of failed actions."""

from itertools import product
from typing import Dict, Iterable, Iterator, List, Mapping, Sequence, Set, Tuple

import clingo
from clingo import Symbol
from clingo.ast import ASTType

from rosoclingo.checking.extension import Kinds
from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.checking.sample_requests import likely_patterns, sample_requests
from rosoclingo.checking.trial_plans import Trials
from rosoclingo.checking.verifying.moves import Repertory
from rosoclingo.checking.verifying.scope import EventSelection
from rosoclingo.checking.verifying.shared_solver import Streams
from rosoclingo.checking.verifying.time_shift import Argument
from rosoclingo.oclingo.program.action_rules import ACTION, FAILED, RETURN, is_action
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence, fixed_signatures
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.progression.terms import Signature, parse_term
from rosoclingo.planning.explaining.atom_patterns import ANY, Patterns, names_of, patterns_of, substitute
from rosoclingo.reasoning.keywords import FAILURE, RESERVED, name_of, request

TRIED, MOST = 8, 40
"""Numbers of requests of a kind that are tried if one of them has a plan with actions, and otherwise."""


def likely_repertory(program: ReactiveProgram, selection: EventSelection) -> Repertory:
    """Return the likely events of a program, as far as the user does not select them."""
    goals = selection.goals or tuple(likely_goals(program, selection.most, selection.kinds))
    facts = tuple(_likely_facts(program, goals, selection))
    actions = Streams(program, [request(one, 1) for one in goals]).actions()
    interfaces = sorted({name for name, _ in actions})
    known = _KnownReturns(program)
    reasons = {name_of(one): known.reasons(one, interfaces, selection.reasons) for one in interfaces}
    return Repertory(goals, facts, reasons)


def likely_goals(program: ReactiveProgram, most: int, kinds: Kinds = ()) -> Iterator[Symbol]:
    """Yield at most ``most`` goals of each kind with different identifiers, preferably those with actions.

    The default for ``kinds`` is formed from the program's rules.
    """
    trials = Trials(program)
    for texts in kinds or sample_requests(program):
        tried: List[Tuple[int, Symbol]] = []  # the goals with their numbers of actions
        for number, text in enumerate(texts):
            if number >= (TRIED if any(actions for actions, _ in tried) else MOST):
                break
            answer = trials.request(text).answer
            tried.append((sum(map(is_action, answer or ())), parse_term(text)))
        yield from _different([goal for _, goal in sorted(tried, key=lambda one: -one[0])], most)


def _different(goals: Sequence[Symbol], most: int) -> List[Symbol]:
    """Return goals with different identifiers and, if possible, different arguments in each place."""
    found: List[Symbol] = []
    for strict in (True, False):
        for goal in goals:
            *rest, last = goal.arguments
            number = last.type is clingo.SymbolType.Number
            one = clingo.Function(goal.name, [*rest, clingo.Number(len(found) + 1)]) if number else goal
            others = [other.arguments for other in found]
            near = any(a == b for other in others for a, b in zip(rest, other)) if strict else False
            same = any(one.arguments[-1] == other[-1] or (number and rest == other[:-1]) for other in others)
            if len(found) < most and not near and not same:
                found.append(one)
    return found


def _likely_facts(program: ReactiveProgram, goals: Sequence[Symbol], selection: EventSelection) -> Iterator[Symbol]:
    """Yield facts of cycle 1 that match body atoms of rules, a limited number of each selected predicate.

    Variables that no other atom of a rule binds range over the things of goals.
    """
    things = dict.fromkeys(one.arguments[-1] for one in goals)
    words = {argument for one in goals for argument in one.arguments}
    for signature in sorted(program.external_signatures):
        name = signature.name
        unobserved = (name, signature.arity) in RESERVED or name in (RETURN.name, FAILED.name) or name[:2] == "__"
        if unobserved or not signature.positive or (selection.facts and name not in selection.facts):
            continue
        places = [one for one in program.survey.using.get(signature, ()) if one.part.parameter]
        patterns = likely_patterns(program, [(one, _present(one, program)) for one in places])
        found = {
            substitute(pattern, dict(zip(names_of(pattern), row)))
            for pattern in patterns
            for row in product(things, repeat=len(names_of(pattern)))
        }
        rows = sorted(tuple(one.arguments) for one in found)
        for row in sorted(rows, key=lambda row: (len(set(row)) < len(row), -len(words & set(row))))[: selection.most]:
            yield clingo.Function(name, row)


def _present(place: Occurrence, program: ReactiveProgram) -> Patterns:
    """Return the patterns of an atom in a rule, with cycle 1 for times."""
    times, constants = place.offsets, program.survey.constants
    terms = [patterns_of(one, {**constants, place.part.parameter: ANY}) for one in place.arguments]
    rows = product(*((clingo.Number(1),) if n in times else one for n, one in enumerate(terms)))
    return tuple(clingo.Function(place.signature.name, row) for row in rows)


class _KnownReturns:
    """The return values that a program's rules distinguish."""

    def __init__(self, program: ReactiveProgram) -> None:
        self._constants, self._values = dict(program.values), ArgumentValues.of(program)
        self._fixed = fixed_signatures(program.parts) - program.external_signatures
        self._stepped = [one for part in program.parts if part.parameter for one in part.found]
        self._flow, self._constants_compared = self._return_flow()

    def reasons(
        self, interface: Symbol, interfaces: Sequence[Symbol], more: Mapping[str, Sequence[Symbol]]
    ) -> Tuple[Symbol, ...]:
        """Return the return values of an interface's failed actions, one for each group that rules treat alike."""
        known = self._uses(set(interfaces) - {interface})
        alike: Dict[Tuple[Tuple[str, ...], ...], Symbol] = {}
        for one in [FAILURE, *sorted(known), *more.get(name_of(interface), ())]:
            alike.setdefault(tuple(sorted(known.get(one, ()))), one)
        return tuple(alike.values())

    def _uses(self, others: Set[Symbol]) -> Dict[Symbol, Set[Tuple[str, ...]]]:
        """Return the values that rules compare returns with, and the uses that distinguish them.

        Atoms of the base part about the interfaces ``others`` do not count.
        """
        found: Dict[Symbol, Set[Tuple[str, ...]]] = {one: {("named", str(one))} for one in self._constants_compared}
        for signature, place in sorted(self._flow):
            for atom in self._values.atoms(signature) if signature in self._fixed else ():
                row = atom.arguments
                rest = [*row[:place], *row[place + 1 :]]
                if not others.intersection(rest):
                    found.setdefault(row[place], set()).add((str(signature), str(place), *map(str, rest)))
        return found

    def _return_flow(self) -> Tuple[Set[Argument], Set[Symbol]]:
        """Return the arguments that rules pass return values to or look them up in, and the constants compared."""
        flow: Set[Argument] = {(RETURN, 1), (FAILED, 1)}
        before = 0
        while before != len(flow):
            before = len(flow)
            for _, found in self._stepped:
                names = _names_at(found, flow)
                heads = {(one, place) for one, place, term in _arguments(found, True) if str(term) in names}
                flow |= {one for one in heads if one[0] != ACTION}
        lookups: Set[Argument] = set()
        terms: List[Node] = []
        for statement, found in self._stepped:
            names = _names_at(found, flow)
            for one, place, term in _arguments(found, False):
                lookups |= {(one, place)} if str(term) in names else set()
                terms += [term] if (one, place) in flow else []
            for node in statement.nodes if names else ():
                if node.ast_type == ASTType.Comparison:
                    sides = [node.term, *(guard.term for guard in node.guards)]
                    terms += sides if any(str(one) in names for one in sides) else []
        values = (evaluate(one, self._constants) for one in terms if one.ast_type != ASTType.Variable)
        words = {one for one in values if one is not None and one.type is clingo.SymbolType.Function}
        return lookups, words


def _arguments(found: Iterable[Occurrence], head: bool) -> Iterator[Tuple[Signature, int, Node]]:
    return ((one.signature, n, term) for one in found if one.head == head for n, term in enumerate(one.arguments))


def _names_at(found: Iterable[Occurrence], places: Set[Argument]) -> Set[str]:
    """Return the variables at some ``places`` of body atoms."""
    row = ((one, place, term) for one, place, term in _arguments(found, False) if term.ast_type == ASTType.Variable)
    return {term.name for one, place, term in row if (one, place) in places} - {"_"}
