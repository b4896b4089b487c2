"""Runs all checks on a program, and sorts their findings without those that comments silence."""

from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.checking.lint.constants import names_used_as_numbers
from rosoclingo.checking.lint.core_keywords import (
    hidden_predicates,
    idle_words,
    mandatory_actions,
    missing_keywords,
    misspelt_cancels,
    status_faults,
    volatile_keywords,
)
from rosoclingo.checking.lint.kinds import ERROR, KINDS, LintFinding
from rosoclingo.checking.lint.misspellings import misspelt_names
from rosoclingo.checking.lint.other_systems import foreign_statements, included_libraries
from rosoclingo.checking.lint.predicates import (
    disjoint_bodies,
    mismatched_atoms,
    rules_without_effect,
    unfounded_predicates,
    unused_predicates,
)
from rosoclingo.checking.lint.punctuation import suspicious_marks
from rosoclingo.checking.lint.silence import read_silences
from rosoclingo.checking.lint.steps import mismatched_steps, unbounded_look_backs, wrong_steps
from rosoclingo.checking.lint.swapped_arguments import swapped_arguments, swapped_keyword_arguments
from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program import checks
from rosoclingo.oclingo.program.languages import language_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

Texts = Iterable[Tuple[str, str]]


def lint_sources(
    sources: Sequence[Source], constants: Optional[Mapping[str, str]] = None, whole: bool = False
) -> Tuple[Optional[ReactiveProgram], List[Fault]]:
    """Return the program and its findings; the program can have errors, and is None if it cannot be read.

    ``whole``: the sources already contain all included files.
    """
    try:
        program = ReactiveProgram(sources, constants, whole, lenient=True)
    except ProgramError as error:
        return None, list(error.faults)
    return program, lint_program(program)


def lint_program(program: ReactiveProgram, core: Optional[bool] = None) -> List[Fault]:
    """Return the findings in a program, including its errors and those that comments silence.

    ``core``: whether the program is for rosoclingo's core; None infers this from its keywords.
    """
    survey, values = program.survey, ArgumentValues.of(program)
    found = [*program.faults, *program.remarks, *program.first_step_messages()]
    found += [
        *unused_predicates(survey),
        *mismatched_atoms(survey, values),
        *disjoint_bodies(values),
        *unfounded_predicates(survey, values),
    ]
    found += [*rules_without_effect(survey), *wrong_steps(survey, program.first_step)]
    found += [*names_used_as_numbers(survey), *swapped_arguments(survey)]
    texts = [(one.name, one.text) for one in program.texts if language_of(one.name) is None]
    found += [*suspicious_marks(texts), *foreign_statements(survey, texts), *included_libraries(texts)]
    if checks.uses_keywords(program.parts) if core is None else core:
        trial = None if program.faults else program.trial
        found += [*missing_keywords(survey), *mandatory_actions(survey, trial), *status_faults(survey, values)]
        found += [
            *volatile_keywords(survey),
            *hidden_predicates(survey),
            *misspelt_cancels(survey),
            *idle_words(program),
        ]
        found += [*unbounded_look_backs(survey), *mismatched_steps(survey), *swapped_keyword_arguments(survey)]
    known = set(map(_place, found))
    found += [one for one in misspelt_names(survey) if _place(one) not in known]
    kinds: Dict[Tuple[str, int, int], Set[str]] = {}
    for one in found:
        kinds.setdefault(_place(one), set()).add(one.kind)
    return [one for one in found if _COVERED_BY.get(one.kind) not in kinds[_place(one)]]


_COVERED_BY = {
    "undefined-operation": "not-interpreted",
    "clingo": "not-interpreted",
    "not-interpreted": "syntax",
    "no-step": "redefinition",
}
"""Kinds of findings that are dropped if another kind reports the same place."""


def _place(fault: Fault) -> Tuple[str, int, int]:
    return fault.file, fault.line, fault.column


def findings(faults: Iterable[Fault], texts: Texts, program_faults: Iterable[Fault] = ()) -> List[LintFinding]:
    """Return the faults that no comment in ``texts`` silences, without duplicates, sorted by file and line.

    ``program_faults`` are always errors, and comments cannot silence them.
    """
    listed = list(texts)
    order = {name: number for number, (name, _) in enumerate(listed)}
    (silenced, odd_comments), errors = read_silences(listed), set(program_faults)
    found = [
        LintFinding(one, ERROR if one in errors else KINDS[one.kind])
        for one in dict.fromkeys([*faults, *odd_comments])
        if one in errors or one.kind not in silenced.get((one.file, one.line), ())
    ]
    return sorted(found, key=lambda one: (order.get(one.fault.file, len(order)), one.fault.line, one.fault.column))


def is_error(finding: LintFinding) -> bool:
    """Return whether a finding is an error, with which the program cannot be used."""
    return finding.severity == ERROR
