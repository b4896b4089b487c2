"""What may come to a program, read from its rules: goals, facts, and the reasons for which actions fail."""

from typing import Dict, Iterable, Iterator, List, Mapping, Sequence, Set, Tuple

import clingo
from clingo import Symbol
from clingo.ast import ASTType

from rosoclingo.checking.more import Kinds
from rosoclingo.checking.sample_requests import sample_requests
from rosoclingo.checking.trial_plans import Trials
from rosoclingo.checking.verifying.moves import FAILURE, Repertory
from rosoclingo.checking.verifying.scope import Wanted
from rosoclingo.checking.verifying.shared_solver import Streams
from rosoclingo.oclingo.program.action_rules import ACTION, is_action
from rosoclingo.oclingo.program.domains import binds, fixed_signatures, names_in, plain_literals
from rosoclingo.oclingo.program.look_back import time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import evaluate, term_signature
from rosoclingo.oclingo.progression.terms import Signature, parse_term
from rosoclingo.reasoning.keywords import FAILED, RESERVED, RETURN, name_of, request

TRIED = 8
"""Requests of a kind that are tried for some that there is something to do for."""

MOST = 40
"""Of which none is found so many are tried, and then taken as they come."""

_THING = "__verified_thing"
_FACT = "__verified_fact"

Place = Tuple[Signature, int]


def likely_repertory(program: ReactiveProgram, wanted: Wanted) -> Repertory:
    """Return what may come to a program."""
    goals = wanted.goals or tuple(likely_goals(program, wanted.most, wanted.kinds))
    knowledge = _Knowledge(program, goals)
    facts = [one for one in knowledge.facts(wanted.most) if not wanted.facts or one.name in wanted.facts]
    reasons = {name_of(one): tuple(knowledge.reasons(one, wanted.reasons)) for one in knowledge.interfaces}
    return Repertory(goals, tuple(facts), reasons)


def likely_goals(program: ReactiveProgram, most: int, kinds: Kinds = ()) -> Iterator[Symbol]:
    """Yield goals with something to do, of each kind so many at the most, each with an identity of its own.

    Without ``kinds`` of requests it is those that the program's rules ask for.
    """
    trials = Trials(program)
    for texts in kinds or sample_requests(program):
        found: List[Tuple[int, Symbol]] = []
        others: List[Symbol] = []
        for number, text in enumerate(texts):
            if number >= (TRIED if found else MOST):
                break
            answer = trials.request(text).answer
            actions = sum(map(is_action, answer or ()))
            others.append(parse_term(text))
            if actions:
                found.append((-actions, others[-1]))
        likely = [term for _, term in sorted(found, key=lambda one: one[0])]
        yield from _different([*likely, *(one for one in others if one not in likely)], most)


def _different(terms: Sequence[Symbol], most: int) -> List[Symbol]:
    """Return goals of which no two have an argument in the same place, as far as can be, or the same identity."""
    found: List[Symbol] = []
    for strict in (True, False):
        for term in terms:
            if len(found) == most:
                return found
            number = clingo.Number(len(found) + 1)
            own = term.arguments[-1].type is clingo.SymbolType.Number
            one = clingo.Function(term.name, [*term.arguments[:-1], number]) if own else term
            taken = any(one.arguments[-1] == other.arguments[-1] for other in found)
            near = any(a == b for other in found for a, b in zip(one.arguments[:-1], other.arguments))
            if (
                not taken
                and not (strict and near)
                and one.arguments[:-1] not in [o.arguments[:-1] for o in found if own]
            ):
                found.append(one)
    return found


class _Knowledge:
    """What base tells of the places in which rules look for facts and returns."""

    def __init__(self, program: ReactiveProgram, goals: Sequence[Symbol]) -> None:
        self._program = program
        self._fixed = fixed_signatures(program.parts) - program.external_signatures
        self._things = list(dict.fromkeys(one.arguments[-1] for one in goals))
        self._words = {argument for one in goals for argument in one.arguments}
        self._queries: Dict[Signature, List[str]] = {}
        for signature in sorted(program.external_signatures):
            known = (signature.name, signature.arity) in RESERVED or signature.name in (RETURN, FAILED)
            if not known and signature.positive and not signature.name.startswith("__"):
                self._queries[signature] = list(dict.fromkeys(self._asking(signature)))
        self._control = self._ground()
        streams = Streams(program, [request(one, 1) for one in goals])
        self.interfaces = sorted({name for name, _ in streams.actions()})

    # -- facts

    def facts(self, most: int) -> Iterator[Symbol]:
        """Yield facts of cycle 1 that rules have a use for, of each predicate so many at the most."""
        atoms = self._control.symbolic_atoms
        for number, signature in enumerate(self._queries):
            known = [one.symbol.arguments for one in atoms.by_signature(f"{_FACT}_{number}", signature.arity + 1)]
            best = min((one[0] for one in known), default=None)  # what binds the arguments best
            likely = [one[1:] for one in known if one[0] == best]
            for one in sorted(likely, key=lambda one: (len(set(one)) < len(one), -self._fits(one), one))[:most]:
                yield clingo.Function(signature.name, one)

    def _fits(self, arguments: Sequence[Symbol]) -> int:
        return len(self._words & set(arguments))

    def _asking(self, signature: Signature) -> Iterator[str]:
        """Yield bodies that bind what rules ask of a predicate, with its arguments."""
        for part in self._program.parts:
            for statement, one in part.atoms:
                if one.signature == signature and not one.head and part.parameter:
                    yield from self._query(statement, one.term, part.parameter)

    def _query(self, statement: Node, term: Node, parameter: str) -> Iterator[str]:
        values = dict(self._program.values)
        arguments = [
            "1" if time_offset(one, parameter, values) is not None else str(one)
            for one in (term.arguments if term.ast_type == ASTType.Function else ())
        ]
        names = {name for one in term.arguments for name in names_in(one)} if arguments else set()
        binding = [one for one in plain_literals(statement) if binds(one, parameter, self._fixed)]
        needed = [one for one in binding if names & set(names_in(one))]
        bound = {name for one in needed for name in names_in(one)}
        body = [*map(str, needed), *(f"{_THING}({name})" for name in sorted(names - bound))]
        if not any(_mentions(one, parameter) for one in arguments):
            head = f"({','.join([str(len(names - bound)), *arguments])})"
            yield f"{head} :- {', '.join(body)}." if body else f"{head}."

    def _ground(self) -> clingo.Control:
        control = clingo.Control(self._program.arguments(), logger=lambda code, text: None)
        self._program.load_into(control)
        lines = [f"{_THING}({one})." for one in self._things]
        for number, texts in enumerate(self._queries.values()):
            lines += [f"{_FACT}_{number}{text}" for text in texts]
        control.add("__verified", [], "\n".join(lines))
        control.ground([("base", []), ("__verified", [])])
        return control

    # -- reasons

    def reasons(self, interface: Symbol, more: Mapping[str, Sequence[Symbol]]) -> List[Symbol]:
        """Return the values for which an action of an interface fails, one of those that rules treat alike."""
        classes: Dict[Tuple[object, ...], Symbol] = {}
        named = dict.fromkeys(more.get(name_of(interface), ()))
        known = self._columns(interface)
        for one in [FAILURE, *sorted(known), *named]:
            kind = tuple(sorted(known.get(one, ()), key=str))
            classes.setdefault(kind, one)
        return list(classes.values())

    def _columns(self, interface: Symbol) -> Dict[Symbol, Set[Tuple[str, ...]]]:
        """Return what rules compare returned values with, each with all that tells it from others."""
        found: Dict[Symbol, Set[Tuple[str, ...]]] = {}
        places, constants = self._reason_places
        for one in constants:
            found.setdefault(one, set()).add(("named", str(one)))
        for signature, place in sorted(places):
            for atom in self._control.symbolic_atoms.by_signature(signature.name, signature.arity, signature.positive):
                row = atom.symbol.arguments
                others = [*row[:place], *row[place + 1 :]]
                if not set(others) & set(self.interfaces) - {interface}:
                    found.setdefault(row[place], set()).add((str(signature), str(place), *map(str, others)))
        return found

    @property
    def _reason_places(self) -> Tuple[Set[Place], Set[Symbol]]:
        """Return the places in predicates of base that returned values are looked up in, and words they are held to."""
        flow: Set[Place] = {(Signature(RETURN, 3), 1), (Signature(FAILED, 3), 1)}
        before = 0
        while before != len(flow):
            before = len(flow)
            for part in self._program.parts:
                for _, found in part.found if part.parameter else ():
                    names = set(_names_at(found, flow, head=False))
                    heads = (place for place, name in _variables(found, head=True) if name in names)
                    flow |= {place for place in heads if place[0] != ACTION}
        lookups: Set[Place] = set()
        words: Set[Symbol] = set()
        for part in self._program.parts:
            for statement, found in part.found if part.parameter else ():
                names = set(_names_at(found, flow, head=False))
                lookups |= {place for place, name in _variables(found, head=False) if name in names}
                words |= set(self._constants(statement, found, flow, names))
        return {one for one in lookups if one[0] in self._fixed}, words

    def _constants(
        self, statement: Node, found: Sequence[object], flow: Set[Place], names: Set[str]
    ) -> Iterator[Symbol]:
        """Yield the words that stand where a returned value does, or that one is compared with."""
        for signature, place, term in _arguments(found, head=False):
            if (signature, place) in flow:
                yield from self._word(term)
        for literal in statement.body if hasattr(statement, "body") else ():
            for node in literal.nodes:
                if node.ast_type == ASTType.Comparison:
                    terms = [node.term, *(guard.term for guard in node.guards)]
                    if any(one.ast_type == ASTType.Variable and one.name in names for one in terms):
                        for one in terms:
                            yield from self._word(one)

    def _word(self, term: Node) -> Iterator[Symbol]:
        value = None if term.ast_type == ASTType.Variable else evaluate(term, dict(self._program.values))
        if value is not None and value.type is clingo.SymbolType.Function:
            yield value


def _arguments(found: Iterable, head: bool) -> Iterator[Tuple[Signature, int, Node]]:
    for one in found:
        if one.head == head and one.term.ast_type == ASTType.Function:
            for place, term in enumerate(one.term.arguments):
                yield term_signature(one.term), place, term


def _variables(found: Iterable, head: bool) -> Iterator[Tuple[Place, str]]:
    for signature, place, term in _arguments(found, head):
        if term.ast_type == ASTType.Variable:
            yield (signature, place), term.name


def _names_at(found: Iterable, places: Set[Place], head: bool) -> Iterator[str]:
    return (name for place, name in _variables(found, head) if place in places)


def _mentions(text: str, parameter: str) -> bool:
    return parameter in text.replace("(", " ").replace(")", " ").replace(",", " ").split()
