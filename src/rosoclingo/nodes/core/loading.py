"""Read and check the parameters of the core node, and load its program."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Tuple

from rosoclingo.checking.lint.actions import PlacedName, lint_labels
from rosoclingo.checking.lint.linting import findings, is_error, lint_program
from rosoclingo.common.labels import DEFAULT_FRAME, Label, LabelError, LabelTable
from rosoclingo.common.parameters import ParameterError, Parameters
from rosoclingo.common.reading import Reader
from rosoclingo.oclingo import ProgramError, ProgressionError, ReactiveProgram, parse_term
from rosoclingo.oclingo.program.constants import check_given_values
from rosoclingo.oclingo.program.sources import Source, parse_constants
from rosoclingo.oclingo.program.survey import LABELS, label_facts
from rosoclingo.reasoning.journal.resuming import RESUMES
from rosoclingo.reasoning.settings import CoreSettings

#: Kinds of plans: the best within a time limit, or the shortest without a time limit.
PLANS = ("soon", "shortest")

#: Values of the journal's folder: the default folder, and no journal; an empty value is NONE, too.
AUTO, NONE = "auto", "none"

#: The shortest value of the time-out of interfaces, in seconds.
SHORTEST_SILENCE = 3.0

#: The name of the facts of ``~places`` in messages.
PLACES = "~places"


@dataclass(frozen=True)
class CoreParameters:
    """The parameters of the core node.

    ``floor`` is text that is added to the program. ``places`` are the labels with known poses.
    ``recovery_timeout`` and ``plan_time`` are in seconds of processor time. ``journal`` is a folder, AUTO or
    NONE. :mod:`rosoclingo.common.required_node` reads ``required`` itself, even if other parameters are invalid.
    """

    program_files: Tuple[str, ...]
    constants: Dict[str, str]
    labels: Tuple[str, ...]
    settings: CoreSettings
    recovery_timeout: float = 5.0
    plan: str = PLANS[0]
    plan_time: float = 1.0
    journal: str = AUTO
    resume: str = RESUMES[0]
    required: bool = False
    floor: str = ""
    places: Tuple[Label, ...] = ()

    @property
    def time_to_shorten(self) -> Optional[float]:
        """The solver's time to search for a shorter plan than the first; None if each plan has to be the shortest."""
        return None if self.plan == "shortest" else self.plan_time

    @property
    def deciding(self) -> Dict[str, Any]:
        """The parameters that affect decisions, by name, and the poses in the map and the titles of the labels."""
        times = {"plan": self.plan, "plan_time": self.plan_time, "recovery_timeout": self.recovery_timeout}
        labels = {one.name: [one.x, one.y, one.yaw] for one in self.places if one.frame == DEFAULT_FRAME}
        titles = {one.name: one.title for one in self.places if one.title}
        return {**asdict(self.settings), **times, "labels": labels, "titles": titles}


def core_parameters(values: Optional[Mapping[str, Any]] = None) -> CoreParameters:
    """Read the node's private parameters, or ``values``; raises ParameterError with all their faults."""
    given, defaults = Parameters(values), CoreSettings()
    limit = "seconds, 0 for no limit"
    settings = CoreSettings(
        horizon_limit=given.at("horizon_limit").whole(defaults.horizon_limit, low=1),
        search_timeout=given.at("search_timeout").number(defaults.search_timeout, low=0.0, wanted=limit),
        action_timeout=given.at("action_timeout").number(defaults.action_timeout, low=0.0, wanted=limit),
        interface_timeout=_interface_timeout(given.at("interface_timeout"), defaults.interface_timeout),
        lost_timeout=given.at("lost_timeout").number(defaults.lost_timeout, low=0.0, wanted=limit),
        preempt=given.at("preempt").flag(defaults.preempt),
        goals_at_once=given.at("goals_at_once").whole(defaults.goals_at_once, low=0),
        overtaking_limit=given.at("overtaking_limit").whole(defaults.overtaking_limit, low=0),
        learn_durations=given.at("learn_durations").flag(defaults.learn_durations),
    )
    constants = given.at("constants").entries("a map of names to values, {offices: 4}", {})
    found = CoreParameters(
        program_files=_files(given.at("program_files")),
        constants={name: _term(value, str(value.value)) for name, value in constants},
        labels=_labels(given.at("labels")),
        places=_places(given.at("labels").value),
        settings=settings,
        recovery_timeout=given.at("recovery_timeout").number(CoreParameters.recovery_timeout, low=0.0, wanted=limit),
        plan=given.at("plan").choice(PLANS, CoreParameters.plan),
        plan_time=given.at("plan_time").number(CoreParameters.plan_time, low=0.0, wanted="seconds"),
        journal=given.at("journal").text(CoreParameters.journal, empty=True, wanted="a folder, auto or none"),
        resume=_resume(given.at("resume")),
        required=given.at("required").flag(CoreParameters.required),
        floor=given.at("places").text(CoreParameters.floor, empty=True, wanted="facts, the output of places"),
    )
    given.check()
    return found


def _interface_timeout(reader: Reader, default: float) -> float:
    seconds = reader.number(default, low=0.0, wanted="seconds, 0 for never")
    if 0 < seconds < SHORTEST_SILENCE:
        fix = f"use at least {SHORTEST_SILENCE:g}, or 0 for never"
        reader.fault(f"has to be longer, since interfaces announce themselves once a second: {fix}")
    return seconds


def load_program(parameters: CoreParameters) -> Tuple[ReactiveProgram, List[str]]:
    """Load the reactive program that the parameters name, and return it with the findings of the lint.

    Raises ProgramError with all faults of the program, ParameterError for constants that do not fit it.
    """
    sources = [Source.from_file(Path(name)) for name in parameters.program_files]
    sources += [Source(PLACES, parameters.floor)] if parameters.floor else []
    sources.append(label_facts(parameters.labels))
    try:
        program = ReactiveProgram(sources, parameters.constants)
    except ProgramError:
        if parameters.constants:  # the fault can be the value of a constant
            _check_constants(ReactiveProgram(sources), parameters.constants)
        raise
    _check_constants(program, parameters.constants)
    texts = [(one.name, one.text) for one in program.texts]
    labels = [PlacedName(str(parse_term(label)), LABELS, 0, 0) for label in parameters.labels]
    faults = [*lint_program(program, core=True), *lint_labels(program, labels)]
    return program, [str(one) for one in findings(faults, texts)]


def _check_constants(program: ReactiveProgram, given: Mapping[str, str]) -> None:
    """Raise ParameterError, which lists invalid values of the program's constants."""
    found = findings(check_given_values(program.survey, parse_constants(given)), ())
    faults = [one.fault for one in found if is_error(one)]
    if faults:
        raise ParameterError("\n".join(f"~constants: {one.message} ({one.remedy})" for one in faults))


def _resume(reader: Reader) -> str:
    """Return one of RESUMES; YAML reads two of these words as true and false."""
    if isinstance(reader.value, bool):
        reader = reader.holding("yes" if reader.value else "no")
    return reader.choice(RESUMES, CoreParameters.resume)


def _files(reader: Reader) -> Tuple[str, ...]:
    wanted = "a list of paths of ASP programs"
    names = (reader.text(wanted=wanted),) if isinstance(reader.value, str) else reader.texts(wanted=wanted, some=True)
    for name in names:
        if not Path(name).is_file():
            reader.fault(f"there is no file '{name}'")
    return names


def _labels(reader: Reader) -> Tuple[str, ...]:
    if isinstance(reader.value, list):
        return tuple(_term(label, str(label.value)) for label in reader.items())
    return tuple(
        _term(reader, name) for name, _ in reader.entries("a map whose keys are the labels, or a list of them", {})
    )


def _places(value: Any) -> Tuple[Label, ...]:
    """Return the labels; the nodes that use poses report their faults, not the core."""
    try:
        return tuple(LabelTable.from_mapping(value))
    except LabelError:
        return ()


def _term(reader: Reader, text: str) -> str:
    try:
        parse_term(text)
    except ProgressionError as error:
        reader.fault(f"'{text}' is not an ASP term: {error}")
    return text
