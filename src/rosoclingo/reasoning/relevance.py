"""Relevance analysis: from which external atoms can a rule derive something?

The analysis is conservative: an atom counts as relevant unless the rules exclude it. It grounds the predicates of the
base part that restrict a rule. For example, ``room`` restricts ``wanted(R,t) :- _request(visit(R),t+1), room(R).``

Some rules only relay an atom, such as ``asked(R,t) :- _request(visit(R),t+1).`` The atom is relevant if the derived
atom is relevant.
"""

from functools import cached_property, lru_cache
from itertools import islice
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, ComparisonOperator, ProgramBuilder, Sign

from rosoclingo.oclingo.program.literals import is_plain_atom, mentions, names_in
from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.program.parts import Part, fixed_signatures
from rosoclingo.oclingo.program.patterns import FAR, Pattern
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import arguments_of, atom_terms, term_signature
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.reasoning.likely_terms import Misfit, bindings, correct, fit_to_form, join_texts, likeness

_STATED, _RELEVANT = "__oclingo_stated", "__oclingo_relevant"
_IRRELEVANT = (ASTType.ShowTerm, ASTType.ShowSignature, ASTType.Heuristic, ASTType.ProjectAtom, ASTType.Defined)
_MOST = 10000  # maximum number of atoms of a restricting predicate; larger predicates count as no restriction
_MOST_TRIED = 100  # maximum number of relayed atoms and of excluding rules; beyond it, an atom counts as relevant


class _Occurrence(NamedTuple):
    """An occurrence of an atom in a statement.

    Attributes:
        pattern: the pattern of matching atoms.
        term: the atom in the statement.
        kept: the literals that restrict its instances.
        rule: a program that derives the consequences of an instance, None if that is undecided.
        relay: the predicate of the head if the rule only relays the atom, else None.
        counts: whether the atom is positive, or negative with a constant in its first argument.
        statement: the statement.

    """

    pattern: Pattern
    term: Node
    kept: List[Node]
    rule: Optional[str]
    relay: Optional[Signature]
    counts: bool
    statement: Node


_Trail = List[Tuple[_Occurrence, clingo.Symbol]]


class RelevanceAnalysis:
    """The relevant external atoms of a program, computed on demand."""

    def __init__(self, program: ReactiveProgram) -> None:
        self._program = program
        self._occurrences: Dict[Signature, List[_Occurrence]] = {}

    @classmethod
    @lru_cache(maxsize=1)
    def of(cls, program: ReactiveProgram) -> "RelevanceAnalysis":
        """Return the shared analysis of a program."""
        return cls(program)

    def is_relevant(self, atom: clingo.Symbol) -> bool:
        """Return whether some rule can derive something from an atom; False is certain."""
        return self._excluding_rules(atom) is None

    def advice(self, atom: clingo.Symbol) -> str:
        """Return advice about an irrelevant ``atom``: a correction, else the reason, else the known forms."""
        term = atom.arguments[0]
        forms = self._forms(signature_of(atom), term)
        alike = filter(None, (fit_to_form(form, term) for form in forms))
        for form in dict.fromkeys((term, *sorted(alike, key=lambda one: likeness(str(one), str(term)), reverse=True))):
            meant = correct(form, self._misfits(_with_first(atom, form)))
            if meant is not None and self.is_relevant(_with_first(atom, meant)):
                return f"did you mean {meant}?"
        misfits, excluding = self._misfits(atom), self._excluding_rules(atom)
        if misfits:
            return "; ".join(dict.fromkeys(f"{one} is none of {join_texts(map(str, known))}" for one, known in misfits))
        if excluding:
            places = (place.statement.location.begin for place, _ in excluding)
            return f"the conditions of {join_texts(f'{one.filename}:{one.line}' for one in places)} exclude it"
        return f"rules match {join_texts(map(str, forms), in_order=True)}" if forms else "write a rule for it"

    def _forms(self, signature: Signature, term: clingo.Symbol) -> List[Node]:
        """Return the first arguments that rules accept, ordered by the similarity of their names to ``term``."""
        occurrences = self._occurrences_of(signature)
        forms = list(dict.fromkeys(one.term.arguments[0] for one in occurrences if one.counts))
        name = str(term).partition("(")[0]
        named = [one for one in forms if one.ast_type != ASTType.Variable and getattr(one, "name", "") != "cancel"]
        return sorted(named, key=lambda one: likeness(str(one).partition("(")[0], name), reverse=True)

    # -- rules that see an atom

    def _excluding_rules(self, atom: clingo.Symbol) -> Optional[_Trail]:
        """Return the rules that match an atom but exclude it; None if the atom is relevant."""
        failed: _Trail = []
        waiting: List[Tuple[clingo.Symbol, FrozenSet[Signature]]] = [(atom, frozenset())]
        while waiting:
            one, handed_on = waiting.pop()
            for place in self._matching(one):
                if place.relay is not None and place.relay in handed_on:
                    continue
                found = self._instances(place, one)
                if found is None or (found and place.relay is None) or max(len(found), len(failed)) > _MOST_TRIED:
                    return None
                failed += [] if found else [(place, one)]
                waiting += [(head, handed_on | {signature_of(head)}) for head in found]
        return failed

    def _matching(self, atom: clingo.Symbol) -> List[_Occurrence]:
        """Return the occurrences that match an atom; only those that count, if there are any."""
        first = self._program.first_step
        occurrences = self._occurrences_of(signature_of(atom))
        seen = [one for one in occurrences if one.pattern.can_match(atom, first, FAR)]
        return [one for one in seen if one.counts] or seen

    def _occurrences_of(self, signature: Signature) -> List[_Occurrence]:
        """Return the occurrences of a predicate in the program."""
        if signature not in self._occurrences:
            self._occurrences[signature] = [
                place
                for part in self._program.parts
                for statement, atoms in part.found
                if any(one.signature == signature and not one.head for one in atoms)
                if statement.ast_type not in _IRRELEVANT
                for place in self._look(part, statement, signature)
            ]
        return self._occurrences[signature]

    def _look(self, part: Part, statement: Node, signature: Signature) -> Iterator[_Occurrence]:
        relay = self._relay(statement)
        handed_to = None if relay is None else term_signature(relay)
        for first, row in _rows(statement):
            for literal in filter(_is_atom, first):
                for term in atom_terms(literal.atom.symbol):
                    if term_signature(term) != signature:
                        continue
                    pattern = Pattern(term, part.parameter, statement, dict(self._program.values))
                    kept = self._kept(term, [one for one in row if one is not literal], part.parameter)
                    rule = self._rule(pattern, term, kept, relay)
                    counts = literal.sign == Sign.NoSign or _names_a_constant(term)
                    yield _Occurrence(pattern, term, kept, rule, handed_to, counts, statement)

    def _rule(self, pattern: Pattern, term: Node, kept: List[Node], relay: Optional[Node]) -> Optional[str]:
        """Return a program that derives the relayed head of a rule, or 0; None if that depends on the step."""
        if pattern.parameter and not pattern.offsets and mentions(term, pattern.parameter):
            return None
        body = [_stated(arguments_of(term)), *map(str, kept)]
        facts = [
            f"{one}." if certain else f"{{{one}}}."
            for signature in {term_signature(one.atom.symbol) for one in kept if _is_atom(one)}
            for one, certain in self._table(signature) or ()
        ]
        head = f"{_RELEVANT}({0 if relay is None else relay})"
        return "\n".join([*facts, f"#program relevant({pattern.parameter or 't'}).", f"{head} :- {'; '.join(body)}."])

    def _relay(self, statement: Node) -> Optional[Node]:
        """Return the head of a rule that only derives an atom for other rules; None for any other statement."""
        if statement.ast_type != ASTType.Rule or not is_plain_atom(statement.head):
            return None
        term = statement.head.atom.symbol
        plain = term.ast_type == ASTType.Function and not term.name.startswith("_")
        return term if plain and term_signature(term) in self._used else None

    @cached_property
    def _used(self) -> Set[Signature]:
        """The predicates that some statement uses without defining them."""
        statements = [one for part in self._program.parts for one in part.found if one[0].ast_type not in _IRRELEVANT]
        heads = [{one.signature for one in atoms if one.head} for _, atoms in statements]
        pairs = zip(heads, (atoms for _, atoms in statements))
        return {one.signature for own, atoms in pairs for one in atoms if not one.head and one.signature not in own}

    # -- consequences of an atom in a rule

    def _instances(self, place: _Occurrence, atom: clingo.Symbol) -> Optional[List[clingo.Symbol]]:
        """Return the relayed heads that a rule derives from an atom, 0 for other heads; None if that is undecided."""
        if place.rule is None:
            return None
        step = place.pattern.first_match(atom, -FAR, FAR) if place.pattern.offsets else None
        if step is None:
            step = next((one.number for one in atom.arguments[-1:] if one.type is clingo.SymbolType.Number), 1)
        try:
            control = self._control()
            control.add("base", [], f"{_stated(atom.arguments)}.\n{place.rule}")
            control.ground([("base", []), ("relevant", [clingo.Number(step)])])
        except RuntimeError:
            return None
        return [one.symbol.arguments[0] for one in control.symbolic_atoms.by_signature(_RELEVANT, 1)]

    def _control(self) -> clingo.Control:
        constants = [f"-c{name}={value}" for name, value in self._program.values.items()]
        return clingo.Control([*constants, "-Wnone"], logger=lambda code, message: None)

    def _kept(self, term: Node, row: List[Node], parameter: str) -> List[Node]:
        """Return the literals that restrict a rule at every step, independently of other facts."""
        bound = set(names_in(term))
        timeless = [one for one in row if not (parameter and mentions(one, parameter))]
        atoms = [one for one in timeless if _is_atom(one) and self._restricts(one.atom.symbol)]
        kept = list(filter(is_plain_atom, atoms))
        bound.update(name for one in kept for name in names_in(one))
        literals = [one for one in timeless if one.ast_type == ASTType.Literal]
        compared = [one for one in literals if one.atom.ast_type == ASTType.Comparison]
        for _ in compared:  # a comparison can bind a variable that another one needs
            for one in compared:
                bound.update(_binds(one, bound))
        return kept + [one for one in (*atoms, *compared) if one not in kept and set(names_in(one)) - {"_"} <= bound]

    def _restricts(self, term: Node) -> bool:
        """Return whether all atoms of a predicate are known before the first update."""
        if term.ast_type == ASTType.Pool:
            return False
        signature, program = term_signature(term), self._program
        undefined = signature not in program.head_signatures | program.external_signatures
        return (undefined or signature in self._known) and self._table(signature) is not None

    @cached_property
    def _known(self) -> Set[Signature]:
        """The predicates that follow from the base part alone, independently of external facts."""
        program = self._program
        found = fixed_signatures(program.parts) - program.external_signatures
        open_ones = (program.head_signatures | program.external_signatures) - found
        before = -1
        while before < len(open_ones):
            before = len(open_ones)
            for part in program.parts:
                for _, atoms in part.found:
                    if any(one.signature in open_ones for one in atoms if not one.head):
                        open_ones |= {one.signature for one in atoms if one.head}
        return found - open_ones

    def _table(self, signature: Signature) -> Optional[List[Tuple[clingo.Symbol, bool]]]:
        """Return the atoms of a base predicate, each with whether it is a fact; None if there are too many."""
        if self._base is None:
            return None
        found = self._base.symbolic_atoms.by_signature(*signature)
        atoms = [(one.symbol, one.is_fact) for one in islice(found, _MOST + 1)]
        return None if len(atoms) > _MOST else atoms

    @cached_property
    def _base(self) -> Optional[clingo.Control]:
        """The ground base part; None if clingo cannot ground it."""
        control = self._control()
        try:
            with ProgramBuilder(control) as builder:
                builder.add(parse("")[0].ast)
                for part in self._program.parts:
                    for one in part.statements if part.name == "base" else ():
                        if one.ast_type == ASTType.Rule:
                            builder.add(one.ast)
            control.ground([("base", [])])
        except RuntimeError:
            return None
        return control

    def _misfits(self, atom: clingo.Symbol) -> List[Misfit]:
        """Return the values of an atom that its rules exclude; none if the atom is relevant."""
        found: List[Misfit] = []
        for place, seen in self._excluding_rules(atom) or ():
            values = dict(bindings(place.term, seen))
            for literal in filter(is_plain_atom, place.kept):
                for position, one in enumerate(arguments_of(literal.atom.symbol)):
                    if one.ast_type == ASTType.Variable and one.name in values:
                        table = self._table(term_signature(literal.atom.symbol)) or ()
                        known = frozenset(row.arguments[position] for row, _ in table)
                        found += [(values[one.name], known)] if values[one.name] not in known else []
        return found


# -- literals


def _rows(statement: Node) -> Iterator[Tuple[List[Node], List[Node]]]:
    """Yield each group of literals of a statement, with all literals that hold in conjunction with it."""
    body = [one for one in getattr(statement, "body", ()) if isinstance(one, Node)]
    yield body, body
    atoms = [one.atom for one in body if one.ast_type == ASTType.Literal]
    heads = [statement.head] if statement.ast_type == ASTType.Rule else []
    elements = [element for one in (*atoms, *heads) for element in getattr(one, "elements", ())]
    for element in [*elements, *(one for one in body if one.ast_type == ASTType.ConditionalLiteral)]:
        inner = getattr(element, "condition", ())
        in_head = bool(heads) and element in getattr(heads[0], "elements", ())
        if isinstance(inner, Node):  # an element of a head aggregate
            inner = inner.condition
        elif element.ast_type == ASTType.ConditionalLiteral and not in_head:
            inner = [element.literal, *inner]
        yield list(inner), [*inner, *body]


def _is_atom(literal: Node) -> bool:
    return bool(literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.SymbolicAtom)


def _binds(comparison: Node, bound: Set[str]) -> Iterator[str]:
    """Yield the variables that an equation binds."""
    atom = comparison.atom
    guards = atom.guards
    if comparison.sign != Sign.NoSign or len(guards) != 1 or guards[0].comparison != ComparisonOperator.Equal:
        return
    for one, other in ((atom.term, guards[0].term), (guards[0].term, atom.term)):
        if one.ast_type == ASTType.Variable and set(names_in(other)) <= bound:
            yield one.name


def _with_first(atom: clingo.Symbol, argument: clingo.Symbol) -> clingo.Symbol:
    return clingo.Function(atom.name, [argument, *atom.arguments[1:]], atom.positive)


def _names_a_constant(term: Node) -> bool:
    """Return whether the first argument of an atom is a constant, or contains one."""
    goal = next(iter(arguments_of(term)), term)
    return not names_in(goal) or any(not names_in(one) for one in arguments_of(goal))


def _stated(arguments: Sequence[object]) -> str:
    return f"{_STATED}({','.join(map(str, arguments))})" if arguments else _STATED
