"""Stream updates against a program: what is no update, what says something that no rule can ever heed."""

import re
from typing import Iterator, List, Sequence, Set, Tuple

import clingo

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo.errors import Fault, ProgressionError
from rosoclingo.oclingo.program.hearing import Hearing
from rosoclingo.oclingo.program.likeness import asked, likely, likely_external, likely_value
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.survey import Place, written
from rosoclingo.oclingo.progression.parser import PlacedUpdate, iterate_placed
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.planning.explaining.atom_patterns import shown

_END = re.compile(r"#(end|stop)[^.]*\.")
_MANY = 4  # atoms of rules that a message lists


def lint_stream(program: ReactiveProgram, text: str, name: str) -> List[Fault]:
    """Return what may be wrong with the updates of the text ``name`` for a program; nothing is solved."""
    updates, found = _read(text, name)
    judge = _Judge(program, name, updates)
    for update in updates:
        found += [Fault(name, line, 1, told, "", "stream-fact") for told, line in _ignored(update)]
        for (line, column), item in zip(update.places, update.update.items):
            if isinstance(item, Statement):
                found += judge.faults(item, line, column)
    return found


def _read(text: str, name: str) -> Tuple[List[PlacedUpdate], List[Fault]]:
    """Return the updates of a text; those with faults are passed over."""
    updates: List[PlacedUpdate] = []
    faults: List[Fault] = []
    while True:
        try:
            updates.extend(iterate_placed(text))
        except ProgressionError as error:
            faults.append(Fault(name, error.line, error.column, error.message, kind="stream-syntax"))
            text = _behind(text, error.line, error.column)
        else:
            return updates, faults


def _behind(text: str, line: int, column: int) -> str:
    """Return the text without what comes before the first update that begins behind a place; its lines stay."""
    lines = text.splitlines(keepends=True)
    offset = sum(map(len, lines[: line - 1])) + column - 1
    end = _END.search(text, min(offset, len(text)))
    return "" if end is None else "\n" * text.count("\n", 0, end.end()) + text[end.end() :]


def _ignored(update: PlacedUpdate) -> Iterator[Tuple[str, int]]:
    for warning in update.update.warnings:
        place = re.search(r"in line ([0-9]+)", warning)
        yield warning, int(place.group(1)) if place else 1


class _Judge:
    """Looks at the statements of a stream one by one."""

    def __init__(self, program: ReactiveProgram, name: str, updates: Sequence[PlacedUpdate]) -> None:
        self._program, self._survey, self._name = program, program.survey, name
        self._values, self._hearing = ArgumentValues.of(program), Hearing.of(program)
        statements = [item for one in updates for item in one.update.items if isinstance(item, Statement)]
        self._stated = {signature_of(one.head) for one in statements if one.head is not None}
        self._asked = {signature_of(literal.atom) for one in statements for literal in one.body}

    def faults(self, statement: Statement, line: int, column: int) -> Iterator[Fault]:
        """Yield what may be wrong with a statement."""
        told = [] if statement.head is None else list(self._of_head(statement.head, bool(statement.body)))
        for literal in statement.body:
            told += self._of_body(literal.atom)
        for message, mend in told:
            yield Fault(self._name, line, column, message, mend, "stream-fact")

    def _of_head(self, atom: clingo.Symbol, is_rule: bool) -> Iterator[Tuple[str, str]]:
        signature, program = signature_of(atom), self._program
        if signature in program.open_signatures:
            if not self._hearing.hears(atom):
                yield f"no rule can ever see {atom}", self._seen_instead(signature)
        elif signature in program.external_signatures:
            yield from self._strange_value(atom, "external")
        elif signature in program.head_signatures:
            yield f"{atom} is no external: rules of the program define {signature}", self._declare(signature)
        elif not is_rule and not self._both(signature) & (self._asked | program.signatures):
            message = f"no rule and no #external of the program mentions {signature}"
            yield message, likely_external(signature, program.external_signatures)

    @staticmethod
    def _both(signature: Signature) -> Set[Signature]:
        """Return a predicate and its classical negation, which one fact may contradict."""
        return {signature, signature._replace(positive=not signature.positive)}

    def _of_body(self, atom: clingo.Symbol) -> Iterator[Tuple[str, str]]:
        signature, program = signature_of(atom), self._program
        known = program.head_signatures | program.external_signatures
        if signature in known:
            yield from self._strange_value(atom, "true")
        elif signature not in self._stated:
            mend = asked(likely(signature, known | self._stated))
            yield f"{signature} is never true: nothing defines it", mend

    def _strange_value(self, atom: clingo.Symbol, what: str) -> Iterator[Tuple[str, str]]:
        """Yield the first argument of an atom that the program never gives its predicate."""
        misfit = self._values.misfit(atom)
        if misfit is not None:
            position, known = misfit
            argument = atom.arguments[position]
            message = f"{signature_of(atom)} is never {what} with {argument} as argument {position + 1}"
            yield message, likely_value(str(argument), list(map(shown, known)))

    def _seen_instead(self, signature: Signature) -> str:
        """Return which atoms of a predicate the rules look at."""
        uses: Sequence[Place] = self._survey.using.get(signature, ())
        terms = dict.fromkeys(written(one.occurrence.term) for one in uses)
        return "rules look at {}".format(", ".join(list(terms)[:_MANY])) if terms else "write a rule for it"

    @staticmethod
    def _declare(signature: Signature) -> str:
        return f"write #external {signature}."
