"""Checks of stream updates against a program: syntax errors, and statements that no rule can see."""

import re
from typing import Iterator, List, Sequence, Tuple

import clingo

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo.errors import Fault, ProgressionError
from rosoclingo.oclingo.program.likeness import did_you_mean, likely_external, likely_value, most_similar
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.survey import term_text
from rosoclingo.oclingo.progression.parser import PlacedUpdate, iterate_placed
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.planning.explaining.atom_patterns import format_pattern
from rosoclingo.reasoning.relevance import RelevanceAnalysis

_MANY = 4  # atoms of rules that a message lists


def lint_stream(program: ReactiveProgram, text: str, name: str) -> List[Fault]:
    """Return the faults of the updates in ``text``, up to the first syntax error; ``name`` is that of the file."""
    updates: List[PlacedUpdate] = []
    found: List[Fault] = []
    try:
        updates.extend(iterate_placed(text))
    except ProgressionError as error:
        found.append(Fault(name, error.line, error.column, error.message, kind="stream-syntax"))
    judge = _StatementLint(program, updates)
    for update, places in updates:
        for warning in update.warnings:
            place = re.search(r"in line ([0-9]+)", warning)
            found.append(Fault(name, int(place.group(1)) if place else 1, 1, warning, "", "stream-fact"))
        for (line, column), item in zip(places, update.items):
            for message, remedy in judge.faults(item) if isinstance(item, Statement) else ():
                found.append(Fault(name, line, column, message, remedy, "stream-fact"))
    return found


class _StatementLint:
    """Finds the faults of statements of a stream."""

    def __init__(self, program: ReactiveProgram, updates: Sequence[PlacedUpdate]) -> None:
        self._program = program
        self._values, self._relevance = ArgumentValues.of(program), RelevanceAnalysis.of(program)
        statements = [item for one in updates for item in one.update.items if isinstance(item, Statement)]
        self._stated = {signature_of(one.head) for one in statements if one.head is not None}
        self._asked = {signature_of(literal.atom) for one in statements for literal in one.body}

    def faults(self, statement: Statement) -> Iterator[Tuple[str, str]]:
        """Yield the faults of a statement, each with its remedy."""
        if statement.head is not None:
            yield from self._head_faults(statement.head, bool(statement.body))
        for literal in statement.body:
            yield from self._body_faults(literal.atom)

    def _head_faults(self, atom: clingo.Symbol, is_rule: bool) -> Iterator[Tuple[str, str]]:
        signature, program = signature_of(atom), self._program
        # a fact also matters to its classical negation, which it contradicts
        both = {signature, signature._replace(positive=not signature.positive)}
        if signature in program.open_signatures:
            if not self._relevance.is_relevant(atom):
                uses = program.survey.using.get(signature, ())
                terms = list(dict.fromkeys(term_text(one.term) for one in uses))[:_MANY]
                remedy = f"rules match {', '.join(terms)}" if terms else "write a rule for it"
                yield f"no rule can ever see {atom}", remedy
        elif signature in program.external_signatures:
            yield from self._impossible_value(atom, signature, "external")
        elif signature in program.head_signatures:
            message = f"{atom} is not an external: rules of the program define {signature}"
            yield message, f"write #external {signature}."
        elif not is_rule and not both & (self._asked | program.signatures):
            message = f"no rule and no #external of the program mentions {signature}"
            yield message, likely_external(signature, program.external_signatures)

    def _body_faults(self, atom: clingo.Symbol) -> Iterator[Tuple[str, str]]:
        signature = signature_of(atom)
        known = self._program.head_signatures | self._program.external_signatures
        if signature in known:
            yield from self._impossible_value(atom, signature, "true")
        elif signature not in self._stated:
            remedy = did_you_mean(most_similar(signature, known | self._stated))
            yield f"{signature} is never true: nothing defines it", remedy

    def _impossible_value(self, atom: clingo.Symbol, signature: Signature, what: str) -> Iterator[Tuple[str, str]]:
        """Yield the first argument of an atom that the program never gives its predicate."""
        impossible = self._values.impossible_value(atom)
        if impossible is not None:
            position, known = impossible
            value = atom.arguments[position]
            message = f"{signature} is never {what} with {value} as argument {position + 1}"
            yield message, likely_value(str(value), list(map(format_pattern, known)))
