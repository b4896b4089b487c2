"""Slips of the pen: rules that give nothing, steps in the wrong place, answers that nobody gets to see."""

from collections import Counter
from typing import Dict, FrozenSet, Iterator, List, Optional, Tuple

import clingo
from clingo.ast import ASTType, ComparisonOperator, Sign

from rosoclingo.checking.lint.actions import Actions
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.domains import names_in
from rosoclingo.oclingo.program.likeness import asked, likely_value, likeness
from rosoclingo.oclingo.program.look_back import longest_look_back, time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.program.survey import Place, Survey, fault_at, written
from rosoclingo.oclingo.progression.terms import Signature

#: What the core reads out of an answer.
_READ = (ACTION, Signature("_status", 3), Signature("_explain", 3))

_REQUEST, _SAYS = Signature("_request", 2), Signature("_says", 2)
_CANCEL = "cancel"

#: In conditions of control programs there is no other way to say it of a parameter.
_CONTROL = ".golog"

_EQUAL = ComparisonOperator.Equal

#: How like "cancel" the name of a request is that stands for it, of 1.
_ALIKE = 0.8


def slips(survey: Survey, first: int) -> List[Fault]:
    """Return the slips that concern no keyword; ``first`` is the first step."""
    steps = _Steps(survey)
    found = [*_tautologies(survey), *_looks_ahead(survey, steps), *_steps_elsewhere(survey, steps)]
    return [*found, *_first_steps(survey, steps, first), *_lower_case(survey), *_same_variables(survey)]


def slips_of_words(program: ReactiveProgram) -> List[Fault]:
    """Return the slips in what the core and a program say to one another."""
    survey = program.survey
    return [*_hidden(survey), *_like_cancel(survey), *_idle_words(program), *_returns_of_parameters(survey)]


def _tautologies(survey: Survey) -> Iterator[Fault]:
    """Yield the rules that need their own head, as where t stands for t-1."""
    for _, statement, _ in survey.statements:
        if statement.ast_type == ASTType.Rule and _is_plain(statement.head):
            own = str(statement.head.atom)
            if any(_is_plain(one) and str(one.atom) == own for one in statement.body):
                message = f"the rule needs its own head {written(statement.head.atom)}: it gives nothing"
                yield fault_at(statement.head, "tautology", message, "is another step meant in the body?")


def _is_plain(literal: Node) -> bool:
    kinds = literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.SymbolicAtom
    return bool(kinds and literal.sign == Sign.NoSign)


def _lower_case(survey: Survey) -> Iterator[Fault]:
    """Yield the names that may be variables of their rules, written small."""
    named = [(statement, list(_words(statement, survey))) for _, statement, _ in survey.statements]
    count = Counter(word for _, words in named for word, _ in words)
    for statement, words in named:
        own = Counter(word for word, _ in words)
        for word, node in words:
            if count[word] == own[word] and f"{word[:1].upper()}{word[1:]}" in set(names_in(statement)):
                variable = f"{word[:1].upper()}{word[1:]}"
                message = f"{word} is a name that stands nowhere else, and the rule has a variable {variable}"
                yield fault_at(node, "lower-case", message, asked(variable))


def _words(statement: Node, survey: Survey) -> Iterator[Tuple[str, Node]]:
    """Yield the names in a rule that may be anything's."""
    for node in statement.nodes if statement.ast_type == ASTType.Rule else ():
        if node.ast_type == ASTType.SymbolicTerm and node.symbol.type is clingo.SymbolType.Function:
            yield str(node.symbol), node


def _same_variables(survey: Survey) -> Iterator[Fault]:
    """Yield the comparisons by which two variables are equal that atoms bind, each by itself."""
    for _, statement, _ in survey.statements:
        body = statement.body if statement.ast_type == ASTType.Rule else ()
        for literal in body if not statement.location.begin.filename.endswith(_CONTROL) else ():
            pair = _equal_variables(literal)
            if pair is not None and set(pair) <= {name for one in body if _is_plain(one) for name in names_in(one)}:
                message = f"{pair[0]} = {pair[1]} says of two variables of atoms that they are one"
                mend = f"write {pair[0]} in the place of {pair[1]}, or {pair[0]} != {pair[1]}"
                yield fault_at(literal, "same-variables", message, mend)


def _equal_variables(literal: Node) -> Optional[Tuple[str, str]]:
    """Return the two variables of X = Y, None for what says anything else."""
    if literal.ast_type != ASTType.Literal or literal.sign != Sign.NoSign:
        return None
    atom = literal.atom
    if atom.ast_type != ASTType.Comparison or len(atom.guards) != 1 or atom.guards[0].comparison != _EQUAL:
        return None
    sides = (atom.term, atom.guards[0].term)
    return (sides[0].name, sides[1].name) if all(one.ast_type == ASTType.Variable for one in sides) else None


# ---- steps ----------------------------------------------------------------------------------------------------------


class _Steps:
    """Which arguments of atoms are the step plus a number, each with this number; found once for each atom."""

    def __init__(self, survey: Survey) -> None:
        self._constants = survey.constants
        self._known: Dict[int, Dict[int, int]] = {}  # by the atom's term, which the survey keeps

    def of(self, place: Place) -> Dict[int, int]:
        """Return them."""
        key = id(place.occurrence.term)
        if key not in self._known:
            self._known[key] = self._find(place)
        return self._known[key]

    def _find(self, place: Place) -> Dict[int, int]:
        if not place.part.parameter:
            return {}
        arguments = place.occurrence.arguments
        found = {n: time_offset(one, place.part.parameter, self._constants) for n, one in enumerate(arguments)}
        return {position: offset for position, offset in found.items() if offset is not None}


def _looks_ahead(survey: Survey, steps: _Steps) -> Iterator[Fault]:
    """Yield the atoms of rules that belong to a later step, whose rules are not there yet."""
    for signature, used in survey.using.items():
        if survey.is_external(signature) or signature not in survey.defining:
            continue
        heads = [steps.of(one) for one in survey.defining[signature] if one.part.parameter]
        if len(heads) == len(survey.defining[signature]):
            yield from (_of_steps(one) for one in used if not one.part.parameter)
        for place in used:
            ahead = _ahead(steps.of(place), heads) if place.statement.ast_type == ASTType.Rule else None
            if ahead is not None:
                step, term = place.part.parameter, written(place.occurrence.term)
                message = f"{term} is defined by the rules of a later step, which are not there yet at step {step}"
                yield place.fault("look-ahead", message, "look at the step itself, or at one before")


def _of_steps(place: Place) -> Fault:
    term = written(place.occurrence.term)
    message = f"{term} stands in base, where the rules of steps that define it are not there yet: it is never true"
    return place.fault("look-ahead", message, "move the statement to #program cumulative(t).")


def _ahead(seen: Dict[int, int], heads: List[Dict[int, int]]) -> Optional[int]:
    """Return the argument in which an atom is of a later step than all heads of its predicate."""
    for position, offset in seen.items():
        if heads and all(position in head and head[position] < offset for head in heads):
            return position
    return None


def _steps_elsewhere(survey: Survey, steps: _Steps) -> Iterator[Fault]:
    """Yield the atom of a predicate whose step is another argument than in all others, of which there are several."""
    for signature in survey.defining:
        places = [*survey.defining[signature], *survey.using.get(signature, ())]
        told = [(one, frozenset(found)) for one in places for found in [steps.of(one)] if found]
        if len(told) < 4 or any(one for one in places if one.part.parameter and not steps.of(one)):
            continue
        for place, positions in told:
            others: FrozenSet[int] = frozenset.intersection(*(other for one, other in told if one is not place))
            if others and not others & positions:
                number = min(others) + 1
                term = written(place.occurrence.term)
                message = f"{term} has its step elsewhere: in all others it is argument {number}"
                yield place.fault("exchanged", message, f"write the step as argument {number}")


def _first_steps(survey: Survey, steps: _Steps, first: int) -> Iterator[Fault]:
    """Yield the facts of steps at which nothing begins: before all that rules look at, or of a step's own rules."""
    for signature, places in survey.defining.items():
        heads = [one for one in places if one.part.parameter]
        uses = survey.using.get(signature, ())
        for position in set.intersection(*(set(steps.of(one)) for one in heads)) if heads else ():
            own = [first + steps.of(one)[position] for one in heads if not _compares_step(one, survey)]
            seen = _least_seen([_first_seen(one, position, steps, survey, first) for one in uses])
            for place in places:
                step = None if place.part.parameter else _number(place.occurrence.arguments[position], survey)
                defined = step is not None and bool(own) and step >= min(own)
                if step is not None and (defined or (seen is not None and step < min(seen, first - 1))):
                    term = written(place.occurrence.term)
                    why = "whose own rules define it" if defined else "at which no rule looks"
                    message = f"{term} is of step {step}, {why}: what holds at first is of step {first - 1}"
                    yield place.fault("first-step", message, f"write {first - 1} for the step")


def _least_seen(steps: List[Optional[int]]) -> Optional[int]:
    known = [one for one in steps if one is not None]
    return min(known) if known and len(known) == len(steps) else None


def _first_seen(place: Place, position: int, steps: _Steps, survey: Survey, first: int) -> Optional[int]:
    """Return the least step that an atom of a rule looks at, None if it is unknown."""
    argument, offset = place.occurrence.arguments[position], steps.of(place).get(position)
    if offset is not None:
        return first + offset
    step, is_variable = place.part.parameter, argument.ast_type == ASTType.Variable
    bounds = longest_look_back(place.statement, step, survey.constants) if step and is_variable else {}
    farthest = bounds.get(argument.name) if is_variable else None
    return _number(argument, survey) if farthest is None else first - farthest


def _compares_step(place: Place, survey: Survey) -> bool:
    """Tell whether a rule compares the step, so that it can hold at some steps only."""
    comparisons = (one for one in place.statement.nodes if one.ast_type == ASTType.Comparison)
    return any(str(node) == place.part.parameter for one in comparisons for node in one.nodes)


def _number(term: Node, survey: Survey) -> Optional[int]:
    value = evaluate(term, survey.constants)
    return value.number if value is not None and value.type is clingo.SymbolType.Number else None


# ---- the core -------------------------------------------------------------------------------------------------------


def _hidden(survey: Survey) -> Iterator[Fault]:
    """Yield what the core would read, but does not get, as other things are shown."""
    shown = [one for _, one, _ in survey.statements if one.ast_type == ASTType.ShowTerm]
    names = {one.term.name for one in shown if one.term.ast_type == ASTType.Function}
    for signature in _READ:
        hides = survey.shown and signature not in survey.shown and signature.name not in names
        if hides and signature in survey.defining:
            message = f"{signature} is not shown, as other predicates are: the core never hears of it"
            yield survey.defining[signature][0].fault("hidden", message, f"write #show {signature}.")


def _like_cancel(survey: Survey) -> Iterator[Fault]:
    """Yield the requests that look like a cancellation misspelt."""
    for place in survey.using.get(_REQUEST, ()):
        term = place.occurrence.arguments[0]
        size = len(term.arguments) if term.ast_type == ASTType.Function else 0
        name = term.name if size else ""
        if name == _CANCEL and size != 1:
            message = f"{written(term)} has {size} arguments: who takes a goal back asks for cancel(Id)"
            yield fault_at(term, "misspelt", message, f"write {_CANCEL}(Id)")
        elif size == 1 and name != _CANCEL and likeness(name, _CANCEL) >= _ALIKE:
            message = f"nobody asks for {written(term)}: who takes a goal back asks for cancel(Id)"
            yield fault_at(term, "misspelt", message, asked(f"{_CANCEL}(...)"))


def _idle_words(program: ReactiveProgram) -> Iterator[Fault]:
    """Yield the words for actions that the program does not have."""
    survey = program.survey
    actions = Actions(program) if _SAYS in survey.defining else None
    for place in survey.defining.get(_SAYS, ()) if actions is not None and actions.all_known else ():
        name = place.occurrence.arguments[0]
        value = evaluate(name, survey.constants)
        if value is not None and actions is not None and str(value) not in actions.parameters:
            message = f"the program has no action {value}"
            yield fault_at(name, "idle-words", message, likely_value(str(value), list(actions.parameters)))


def _returns_of_parameters(survey: Survey) -> Iterator[Fault]:
    """Yield the returns that a rule looks for by what an action is about rather than by its name."""
    for _, statement, atoms in survey.statements:
        acts = [one.arguments for one in atoms if one.signature == ACTION and len(one.arguments) == 3]
        names, parameters = {str(one[0]) for one in acts}, {str(one[1]) for one in acts}
        for one in atoms if statement.ast_type == ASTType.Rule else ():
            first = one.arguments[0] if one.signature == RETURN else None
            if first is not None and first.ast_type == ASTType.Variable and str(first) in parameters - names:
                message = f"{written(one.term)} asks for an action by its parameter {first}"
                yield fault_at(first, "exchanged", message, "a return names the action, _return(Action,Value,C)")
