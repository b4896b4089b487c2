"""Whether a program and the values given to its constants are fit for the core; what is said where they are not."""

from typing import Collection, Dict, List, Mapping, NamedTuple, Optional

from clingo import Symbol, SymbolType
from clingo.ast import ASTType

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.remarks import constant_names, likely_constant
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.reasoning.keywords import ACTION_LIB, REQUEST, RETURN


class _Constant(NamedTuple):
    """A ``#const`` of the program: where it stands, and its own value, None where that is no simple term."""

    place: str
    value: Optional[Symbol]


class Remarks(NamedTuple):
    """What cannot be (``faults``) and what is odd but may be meant (``warnings``)."""

    faults: List[str]
    warnings: List[str]


def program_warnings(program: ReactiveProgram) -> List[str]:
    """What the core misses in a program, with the mend; the program's own warnings come first."""
    found = list(program.warnings)
    if not program.declares_external(REQUEST, 2):
        mend = "write #external _request/2."
        found.append(f"the program takes no goals: it declares no external {REQUEST}/2 ({mend})")
    if program.defines(ACTION_LIB, 3) and not program.declares_external(RETURN, 3):
        mend = "write #external _return/3. and rules for values that are no success"
        found.append(f"the program never learns how its actions end: it declares no external {RETURN}/3 ({mend})")
    if not program.defines(ACTION_LIB, 3):
        mend = "write rules for _action_lib(Action,Parameter,C)"
        found.append(f"the program plans no actions: no rule defines {ACTION_LIB}/3 ({mend})")
    return found


def constant_remarks(program: ReactiveProgram, given: Mapping[str, Symbol]) -> Remarks:
    """What is wrong with values that are given to the program's constants by name."""
    constants, remarks = _constants(program), Remarks([], [])
    mentioned = _mentioned(program) if given.keys() - constants.keys() else ()
    for name, value in given.items():
        if name in constants:
            _compare(name, value, constants[name], remarks)
        elif name not in mentioned:
            remarks.faults.append(f"the program has no #const {name}; {likely_constant(name, constants)}")
    return remarks


def _mentioned(program: ReactiveProgram) -> Collection[str]:
    return {name for part in program.parts for one in part.statements for name in constant_names(one)}


def _compare(name: str, value: Symbol, constant: _Constant, remarks: Remarks) -> None:
    own = constant.value
    if own is None or own.type is not SymbolType.Number:
        return
    text = f"{name} is {value}, but the program's own value is {own} ({constant.place})"
    if value.type is not SymbolType.Number:
        remarks.faults.append(f"{text}: give a number")
    elif value.number < 0 < own.number:
        remarks.warnings.append(f"{text}: is a negative number meant?")


def _constants(program: ReactiveProgram) -> Dict[str, _Constant]:
    found: Dict[str, _Constant] = {}
    for part in program.parts:
        for one in part.statements:
            if one.ast_type == ASTType.Definition:
                begin = one.location.begin
                values = {name: constant.value for name, constant in found.items() if constant.value is not None}
                found[one.name] = _Constant(f"{begin.filename}:{begin.line}", evaluate(one.value, values))
    return found
