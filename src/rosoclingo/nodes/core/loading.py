"""The core node's parameters: read from the parameter server's values, checked, with an error that names the mend."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Mapping, Tuple

from rosoclingo.common.parameters import ParameterError
from rosoclingo.oclingo import ProgramError, ProgressionError, ReactiveProgram, parse_term
from rosoclingo.oclingo.program.sources import Source, parse_constants
from rosoclingo.reasoning import CoreSettings
from rosoclingo.reasoning.program_fitness import constant_remarks, program_warnings


@dataclass(frozen=True)
class CoreParameters:
    """What the core node was told. ``search_timeout`` and ``recovery_timeout`` are in seconds of wall time."""

    program_files: Tuple[str, ...]
    constants: Dict[str, str]
    labels: Tuple[str, ...]
    settings: CoreSettings
    search_timeout: float = 10.0
    recovery_timeout: float = 5.0


def core_parameters(values: Mapping[str, Any]) -> CoreParameters:
    """Check the values of the node's private parameters; raises ParameterError for the first one that is unusable."""
    defaults = CoreSettings()
    settings = CoreSettings(
        horizon_limit=_whole(values, "horizon_limit", defaults.horizon_limit),
        action_timeout=_seconds(values, "action_timeout", defaults.action_timeout),
        preempt=_switch(values, "preempt", defaults.preempt),
        goals_at_once=_whole(values, "goals_at_once", defaults.goals_at_once, 0),
    )
    return CoreParameters(
        program_files=_files(values),
        constants=_constants(values),
        labels=_labels(values),
        settings=settings,
        search_timeout=_seconds(values, "search_timeout", CoreParameters.search_timeout),
        recovery_timeout=_seconds(values, "recovery_timeout", CoreParameters.recovery_timeout),
    )


def load_program(parameters: CoreParameters) -> Tuple[ReactiveProgram, List[str]]:
    """The reactive program of the parameters, and what is odd about it.

    Raises ProgramError with all its faults, ParameterError for constants that do not fit it.
    """
    sources = [Source.from_file(Path(name)) for name in parameters.program_files]
    sources.append(Source("~labels", "".join(f"label({label}).\n" for label in parameters.labels)))
    try:
        program = ReactiveProgram(sources, parameters.constants)
    except ProgramError:
        if parameters.constants:  # perhaps it is a constant that it cannot live with
            _check_constants(ReactiveProgram(sources), parameters.constants)
        raise
    odd = _check_constants(program, parameters.constants)
    return program, [*program_warnings(program), *odd]


def _check_constants(program: ReactiveProgram, given: Mapping[str, str]) -> List[str]:
    """Return what is odd about the constants; raises ParameterError listing those that cannot be."""
    remarks = constant_remarks(program, parse_constants(given))
    if remarks.faults:
        raise ParameterError("\n".join(f"~constants: {fault}" for fault in remarks.faults))
    return [f"~constants: {warning}" for warning in remarks.warnings]


def _files(values: Mapping[str, Any]) -> Tuple[str, ...]:
    found = values.get("program_files", [])
    names: List[Any] = [found] if isinstance(found, str) else found
    if not isinstance(names, list) or not names or not all(isinstance(name, str) and name for name in names):
        raise ParameterError(f"~program_files is {found!r}: give a list of paths of ASP programs")
    for name in names:
        if not Path(name).is_file():
            raise ParameterError(f"~program_files: there is no file '{name}'")
    return tuple(names)


def _constants(values: Mapping[str, Any]) -> Dict[str, str]:
    found = values.get("constants", {})
    if not isinstance(found, dict):
        raise ParameterError(f"~constants is {found!r}: give a map of names to values, {{offices: 4}}")
    for name, value in found.items():
        _term(str(value), f"~constants: the value of '{name}'")
    return {str(name): str(value) for name, value in found.items()}


def _labels(values: Mapping[str, Any]) -> Tuple[str, ...]:
    found = values.get("labels", {})
    if not isinstance(found, (dict, list)):
        raise ParameterError(f"~labels is {found!r}: give a map whose keys are the labels, or a list of them")
    for label in found:
        _term(str(label), "~labels: the label")
    return tuple(str(label) for label in found)


def _term(text: str, what: str) -> None:
    try:
        parse_term(text)
    except ProgressionError as error:
        raise ParameterError(f"{what} '{text}' is no ASP term: {error}") from error


def _whole(values: Mapping[str, Any], name: str, default: int, least: int = 1) -> int:
    found = values.get(name, default)
    if isinstance(found, bool) or not isinstance(found, int) or found < least:
        raise ParameterError(f"~{name} is {found!r}: give a whole number from {least}")
    return found


def _seconds(values: Mapping[str, Any], name: str, default: float) -> float:
    found = values.get(name, default)
    if isinstance(found, bool) or not isinstance(found, (int, float)) or not 0 <= found < float("inf"):
        raise ParameterError(f"~{name} is {found!r}: give seconds, 0 for no limit")
    return float(found)


def _switch(values: Mapping[str, Any], name: str, default: bool) -> bool:
    found = values.get(name, default)
    if not isinstance(found, bool):
        raise ParameterError(f"~{name} is {found!r}: give true or false")
    return found
