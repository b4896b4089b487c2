"""Checks for arguments in the wrong order."""

from collections import Counter
from typing import Dict, Iterator, List, Optional, Sequence, Tuple

from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.nodes import fault_at
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.survey import Survey, term_text
from rosoclingo.oclingo.progression.terms import Signature

_KIND = "exchanged"
_TIMELESS = "_says"
_ALIKE = 2  # least number of other atoms with two arguments the other way round


def swapped_arguments(survey: Survey) -> List[Fault]:
    """Return the atoms with two variables that are the other way round in all other atoms of the predicate."""
    found: List[Fault] = []
    for signature in dict.fromkeys([*survey.defining, *survey.using]):
        atoms = _places(signature, survey)
        if signature.arity > 1 and len(atoms) > _ALIKE:
            found += _swapped_variables(atoms)
    return found


def swapped_keyword_arguments(survey: Survey) -> Iterator[Fault]:
    """Yield the keywords whose cycle is not the last argument, or whose action is not the first."""
    acts = [place for one in (ACTION, RETURN) for place in _places(one, survey)]
    first, second = (Counter(str(one.arguments[n]) for one in acts) for n in (0, 1))
    for name, signature in KEYWORDS.items():
        for place in _places(signature, survey):
            arguments, term = place.arguments, term_text(place.term)
            steps = place.offsets
            if name != _TIMELESS and steps and signature.arity - 1 not in steps:
                message = f"the cycle of {term} is not its last argument"
                yield place.fault(_KIND, message, f"write the cycle as argument {signature.arity}")
            elif signature in (ACTION, RETURN) and arguments[0].ast_type == ASTType.Variable:
                action = str(arguments[1])
                if arguments[1].ast_type == ASTType.SymbolicTerm and first[action] >= second[action]:
                    message = f"{term} has the action {action} as its second argument"
                    yield fault_at(arguments[1], _KIND, message, "write the action as argument 1")


def _places(signature: Signature, survey: Survey) -> List[Occurrence]:
    return [*survey.defining.get(signature, ()), *survey.using.get(signature, ())]


# ---- variables ------------------------------------------------------------------------------------------------------


def _swapped_variables(atoms: Sequence[Occurrence]) -> Iterator[Fault]:
    names = [[one.name if one.ast_type == ASTType.Variable else "_" for one in atom.arguments] for atom in atoms]
    count: Dict[Tuple[int, str], int] = Counter((n, name) for row in names for n, name in enumerate(row))
    for atom, row in zip(atoms, names):
        pair = _pair(row, count)
        if pair is not None and not _mirrors(atom, row, pair):
            one, other = (row[position] for position in pair)
            message = f"all other atoms have {one} and {other} of {term_text(atom.term)} the other way round"
            yield atom.fault(
                _KIND, message, f"write {other} as argument {pair[0] + 1}, {one} as argument {pair[1] + 1}"
            )


def _stem(name: str) -> str:
    """Return a name without its trailing digits and primes."""
    return name.rstrip("'0123456789")


def _pair(row: Sequence[str], count: Dict[Tuple[int, str], int]) -> Optional[Tuple[int, int]]:
    """Return the positions of two arguments that all other atoms have the other way round."""
    for i, one in enumerate(row):
        for j, other in enumerate(row[i + 1 :], i + 1):
            if "_" not in (one, other) and _stem(one) != _stem(other) and max(len(one), len(other)) > 1:
                lone = count[i, one] == 1 and count[j, other] == 1
                if lone and min(count[j, one], count[i, other]) >= _ALIKE:
                    return i, j
    return None


def _mirrors(atom: Occurrence, row: Sequence[str], pair: Tuple[int, int]) -> bool:
    """Return whether the rule also contains the atom with the two arguments swapped."""
    mine = list(map(str, atom.arguments))
    mine[pair[0]], mine[pair[1]] = mine[pair[1]], mine[pair[0]]
    atoms = [one for one in atom.part.atoms if one.statement is atom.statement]
    return any(one.signature == atom.signature and list(map(str, one.arguments)) == mine for one in atoms)
