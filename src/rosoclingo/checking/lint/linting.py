"""All that may be wrong with a program, at once and in order; what a comment silences is left out."""

from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.checking.lint.constants import words_for_numbers
from rosoclingo.checking.lint.exchanged import exchanged, exchanged_words
from rosoclingo.checking.lint.kinds import ERROR, KINDS, LintFinding
from rosoclingo.checking.lint.lone_names import odd_words
from rosoclingo.checking.lint.other_systems import libraries, of_other_systems
from rosoclingo.checking.lint.predicates import disjoint, never_matching, odd_rules, unfounded, unused
from rosoclingo.checking.lint.punctuation import odd_marks
from rosoclingo.checking.lint.silence import Silences
from rosoclingo.checking.lint.steps import histories, other_steps, wrong_steps
from rosoclingo.checking.lint.talk import (
    demanded_actions,
    hidden,
    idle_words,
    like_cancel,
    missing_words,
    statuses,
    statuses_at_the_end,
)
from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program import checks
from rosoclingo.oclingo.program.languages import language_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

Texts = Iterable[Tuple[str, str]]


def lint_sources(
    sources: Sequence[Source], constants: Optional[Mapping[str, str]] = None, whole: bool = False
) -> Tuple[Optional[ReactiveProgram], List[Fault]]:
    """Return a program, which may have faults, and what may be wrong with it; None where it can't even be read.

    With ``whole`` all that the sources include is among them.
    """
    try:
        program = ReactiveProgram(sources, constants, whole, lenient=True)
    except ProgramError as error:
        return None, list(error.faults)
    return program, lint_program(program)


def lint_program(program: ReactiveProgram, core: Optional[bool] = None) -> List[Fault]:
    """Return what may be wrong with a program, with its faults; silenced or not.

    ``core`` says whether it is for rosoclingo's core; without, its keywords tell.
    """
    survey, values = program.survey, ArgumentValues.of(program)
    found = [*program.faults, *program.remarks, *program.first_step_messages()]
    found += [*unused(survey), *never_matching(survey, values), *disjoint(values), *unfounded(survey, values)]
    found += [*odd_rules(survey), *wrong_steps(survey, program.first_step)]
    found += [*words_for_numbers(survey), *exchanged(survey)]
    texts = [(one.name, one.text) for one in program.texts if language_of(one.name) is None]
    found += [*odd_marks(texts), *of_other_systems(survey, texts), *libraries(texts)]
    if checks.uses_keywords(program.parts) if core is None else core:
        trial = None if program.faults else program.trial
        found += [*missing_words(survey), *demanded_actions(survey, trial), *statuses(survey, values)]
        found += [*statuses_at_the_end(survey), *hidden(survey), *like_cancel(survey), *idle_words(program)]
        found += [*histories(survey), *other_steps(survey), *exchanged_words(survey)]
    known = set(map(_place, found))
    found += [one for one in odd_words(survey) if _place(one) not in known]
    kinds: Dict[Tuple[str, int, int], Set[str]] = {}
    for one in found:
        kinds.setdefault(_place(one), set()).add(one.kind)
    return [one for one in found if _SAID_BY.get(one.kind) not in kinds[_place(one)]]


_SAID_BY = {
    "undefined-operation": "not-interpreted",
    "clingo": "not-interpreted",
    "not-interpreted": "syntax",
    "no-step": "redefinition",
}
"""Kinds that are left out where another one reports the same fault."""


def _place(fault: Fault) -> Tuple[str, int, int]:
    return fault.file, fault.line, fault.column


def findings(faults: Iterable[Fault], texts: Texts, grave: Iterable[Fault] = ()) -> List[LintFinding]:
    """Return the faults that no comment in ``texts`` silences, each once, in the order of files and lines.

    Those that are ``grave``, a program's own faults, are errors whatever their kinds are, and can't be silenced.
    """
    listed = list(texts)
    order = {name: number for number, (name, _) in enumerate(listed)}
    silences, errors = Silences(listed), set(grave)
    reported = dict.fromkeys([*faults, *silences.faults])
    found = [
        LintFinding(one, ERROR if one in errors else KINDS[one.kind])
        for one in reported
        if one in errors or not silences.covers(one)
    ]
    return sorted(found, key=lambda one: (order.get(one.fault.file, len(order)), one.fault.line, one.fault.column))


def is_error(finding: LintFinding) -> bool:
    """Tell whether a finding keeps the program from being used."""
    return finding.severity == ERROR
