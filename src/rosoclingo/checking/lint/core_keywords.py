"""Checks of the atoms that a program exchanges with the core: goals, actions, returns and statuses."""

import re
from typing import Dict, Iterator, List, Optional, Set

import clingo
from clingo.ast import ASTType

from rosoclingo.checking.lint.actions import Actions
from rosoclingo.checking.lint.argument_values import STATUS, ArgumentValues
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.first_steps import TrialGrounding
from rosoclingo.oclingo.program.likeness import did_you_mean, likely_value, likeness
from rosoclingo.oclingo.program.nodes import Node, fault_at
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import evaluate, signature_and_arguments
from rosoclingo.oclingo.program.survey import Survey, term_text
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.planning.explaining.atom_patterns import (
    ANY,
    arguments_in,
    format_pattern,
    is_variable,
    matches,
    names_of,
    pattern_in,
    patterns_of,
    substitute,
)

REQUEST = Signature("_request", 2)
#: Predicates that the core reads from an answer.
_READ = (ACTION, STATUS, Signature("_explain", 3))

_SAYS = Signature("_says", 2)
_CANCEL = "cancel"
_ALIKE = 0.8  # least likeness at which the name of a request is taken for a misspelt "cancel"

WORDS = ("accepted", "rejected", "succeeded", "canceled", "aborted")
"""The statuses of a goal, which stand alone or around a reason."""


def missing_keywords(survey: Survey) -> List[Fault]:
    """Return a fault for each predicate that the core needs: requests, actions and returns."""
    acts = ACTION in survey.defining
    rows = (
        (
            not survey.is_external(REQUEST),
            "no-request",
            f"the program takes no goals: it declares no external {REQUEST}",
            f"write #external {REQUEST}.",
        ),
        (
            acts and not survey.is_external(RETURN),
            "no-return",
            f"the program never learns how its actions end: it declares no external {RETURN}",
            f"write #external {RETURN}. and rules for values that mean failure",
        ),
        (
            not acts,
            "no-action",
            f"the program plans no actions: no rule defines {ACTION}",
            "write rules for _action_lib(Action,Parameter,C)",
        ),
    )
    # the first line of the program is their place, so that a comment there can silence them
    return [Fault(survey.first_file, 1, 1, text, remedy, kind) for lacks, kind, text, remedy in rows if lacks]


def mandatory_actions(survey: Survey, trial: Optional[TrialGrounding]) -> List[Fault]:
    """Return a fault if each of the first steps requires an action and the program has no statuses."""
    places = survey.defining.get(ACTION, ())
    if trial is None or not places or STATUS in survey.defining or not trial.demands(ACTION):
        return []
    message = "each step has an action even without an open goal, and without _status/3 no goal ever ends"
    remedy = "plan actions only for open goals, or write rules for _status(Id,succeeded,C)"
    return [places[0].fault("restless", message, remedy)]


def volatile_keywords(survey: Survey) -> List[Fault]:
    """Return a fault for each volatile rule that defines a keyword: it holds only at the last step of a plan."""
    found = []
    for place in (one for signature in KEYWORDS.values() for one in survey.defining.get(signature, ())):
        if place.part.name == "volatile":
            message = f"{term_text(place.term)} holds only at the last step of a plan: its rule is volatile"
            found.append(place.fault("at-the-end", message, "write #program cumulative(t). before the rule"))
    return found


def status_faults(survey: Survey, values: ArgumentValues) -> List[Fault]:
    """Return the faults of rules for ``_status/3``."""
    numbers = [number for number, one in enumerate(values.rules) if one.head.signature == STATUS]
    found: Dict[str, Fault] = {}
    given: Set[str] = set()
    for number in numbers:
        rule, derived = values.rules[number], values.derived_by(number)
        known = [one for one in (derived or rule.head.patterns) if not is_variable(one.arguments[1])]
        words = {_word(one.arguments[1]) for one in known}
        given |= words
        unknown, status = sorted(words - {*WORDS, ANY.name}), signature_and_arguments(rule.head.term)[1][1]
        if unknown:
            message = f"{unknown[0]} is not a status; statuses are {', '.join(WORDS)}"
            fault = fault_at(status, "status-word", message, likely_value(unknown[0], WORDS))
        else:
            message = f"this rule never makes a goal {term_text(status)}: nothing satisfies its body"
            fault = fault_at(status, "unreachable-status", message, "check its body")
        if unknown or not derived:
            found.setdefault(f"{fault.line}:{fault.column}", fault)
    misspelt = any(one.kind == "status-word" and "mean succeeded" in one.remedy for one in found.values())
    if numbers and not given & {"succeeded", ANY.name} and not misspelt and survey.is_external(REQUEST):
        message = "no rule reports that a goal has succeeded: clients wait forever"
        place = survey.defining[STATUS][0]
        found["none"] = place.fault("no-success", message, "write a rule for _status(Id,succeeded,C)")
    return list(found.values())


def _word(status: clingo.Symbol) -> str:
    """Return the word of a status without its reason."""
    named = status.type is clingo.SymbolType.Function and status.name and len(status.arguments) < 2
    return status.name if named else str(status)


def hidden_predicates(survey: Survey) -> Iterator[Fault]:
    """Yield the predicates that the core reads and the program hides by showing only others."""
    shown = [one for _, one, _ in survey.statements if one.ast_type == ASTType.ShowTerm]
    names = {one.term.name for one in shown if one.term.ast_type == ASTType.Function}
    for signature in _READ:
        hides = survey.shown and signature not in survey.shown and signature.name not in names
        if hides and signature in survey.defining:
            message = f"{signature} is not shown, although other predicates are: the core never receives it"
            yield survey.defining[signature][0].fault("hidden", message, f"write #show {signature}.")


def misspelt_cancels(survey: Survey) -> Iterator[Fault]:
    """Yield the requests that look like a misspelt cancel."""
    for place in survey.using.get(REQUEST, ()):
        term = place.arguments[0]
        size = len(term.arguments) if term.ast_type == ASTType.Function else 0
        name = term.name if size else ""
        if name == _CANCEL and size != 1:
            message = f"{term_text(term)} has {size} arguments: clients cancel a goal by cancel(Id)"
            yield fault_at(term, "misspelt", message, f"write {_CANCEL}(Id)")
        elif size == 1 and name != _CANCEL and likeness(name, _CANCEL) >= _ALIKE:
            message = f"no client sends {term_text(term)}: clients cancel a goal by cancel(Id)"
            yield fault_at(term, "misspelt", message, did_you_mean(f"{_CANCEL}(...)"))


def idle_words(program: ReactiveProgram) -> Iterator[Fault]:
    """Yield the ``_says`` facts about actions, goals and facts that the program does not have."""
    survey = program.survey
    actions = Actions(program) if _SAYS in survey.defining else None
    known = [] if actions is None else [*actions.parameters, *(one.partition("(")[0] for one in actions.parameters)]
    for place in survey.defining.get(_SAYS, ()) if actions is not None else ():
        name, text = place.arguments
        value = evaluate(name, survey.constants)
        if value is None or str(value) in known:
            continue
        goal = pattern_in(value.string) if value.type is clingo.SymbolType.String else None
        if goal is not None and arguments_in(goal):
            yield from _idle_patterns(survey, name, goal, text)
        elif actions is not None and actions.all_known:
            message = f"the program has no action {value}"
            yield fault_at(name, "idle-words", message, likely_value(str(value), list(dict.fromkeys(known))))


def _idle_patterns(survey: Survey, name: Node, goal: clingo.Symbol, text: Node) -> Iterator[Fault]:
    """Yield a fault for a sentence about neither goals nor external facts, and for its names without a variable."""
    terms = [one.arguments[0] for one in survey.using.get(REQUEST, ())]
    asked = [substitute(one, {}) for term in terms for one in patterns_of(term, survey.constants)]
    external = survey.is_external(Signature(goal.name, len(goal.arguments)))
    if not external and not any(matches(goal, one, {}) for one in asked):
        goals = dict.fromkeys(term_text(one) for one in terms if not str(one).startswith(f"{_CANCEL}("))
        yield fault_at(
            name,
            "idle-words",
            f"{format_pattern(goal)} is no goal of the program and no external fact",
            f"rules ask for {', '.join(goals)}",
        )
    value = evaluate(text, survey.constants)
    named = (
        re.findall(r"\{(\w+)\}", value.string) if value is not None and value.type is clingo.SymbolType.String else ()
    )
    for one in dict.fromkeys(named):
        if one not in names_of(goal):
            yield fault_at(
                text, "idle-words", f"{format_pattern(goal)} has no variable {one}", "name one of its variables"
            )
