"""The option ``--verify`` of the command ``check``."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, List, Optional

from clingo import Symbol

from rosoclingo.checking.extension import CheckExtension
from rosoclingo.checking.verifying.scope import SECONDS, DefectKind, EventSelection, VerifyLimits
from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.service.arguments import natural, positive, seconds

if TYPE_CHECKING:
    from rosoclingo.checking.verifying.verification import Verification

_DEPTH = 2
_LIMITS = VerifyLimits()

_VERIFY = (
    "look for a stream of at most DEPTH events (goals, cancels, facts, failures) that breaks the program "
    f"(default: {_DEPTH})"
)
_SECONDS = "processor time for that (default: %(default)g)"
_GOAL = (
    "a goal that may come, as in goal(office1,office2,1); may be repeated (default: some with something to do, of "
    "those of --orders or else of those that the rules ask for)"
)
_FACT = "only facts of this name may come, as in _blocked; may be repeated; none: no facts (default: all declared)"
_EACH = "goals of each kind, and facts of each name, that may come (default: %(default)s)"
_LATE = "cycles that facts may be late (default: %(default)s)"
_EARLY = "cycles that facts may be early (default: %(default)s)"
_TOGETHER = "events between two updates (default: %(default)s)"
_NEVER = "what must never be so at a step t, as the body of a rule; may be repeated"
_SKIP = "do not look for these faults; may be repeated: " + ", ".join(one.value for one in DefectKind)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verification."""
    add = parser.add_argument_group("verify").add_argument
    kinds = [one.value for one in DefectKind]
    for name, settings, words in (
        ("--verify", {"type": positive, "nargs": "?", "const": _DEPTH, "metavar": "DEPTH"}, _VERIFY),
        ("--verify-seconds", {"type": seconds, "default": SECONDS, "metavar": "S"}, _SECONDS),
        ("--goal", {"action": "append", "default": [], "metavar": "GOAL"}, _GOAL),
        ("--fact", {"action": "append", "default": [], "metavar": "NAME"}, _FACT),
        ("--each", {"type": positive, "default": EventSelection().most, "metavar": "N"}, _EACH),
        ("--late", {"type": natural, "default": _LIMITS.late, "metavar": "N"}, _LATE),
        ("--early", {"type": natural, "default": _LIMITS.early, "metavar": "N"}, _EARLY),
        ("--together", {"type": positive, "default": _LIMITS.together, "metavar": "N"}, _TOGETHER),
        ("--one-plan", {"action": "store_true"}, "only the plans that the solver finds, not all shortest ones"),
        ("--never", {"action": "append", "default": [], "metavar": "BODY"}, _NEVER),
        ("--skip", {"action": "append", "default": [], "metavar": "KIND", "choices": kinds}, _SKIP),
    ):
        add(name, help=words, **settings)  # type: ignore[arg-type]


def sources(options: argparse.Namespace) -> List[Source]:
    """Return the rules for what must never be."""
    bodies = [body.strip().rstrip(".") for body in options.never]
    rules = [f"_never({_quoted(body)},t) :- {body}.\n" for body in bodies]
    return [Source("--never", "#program cumulative(t).\n" + "".join(rules), Path())] if rules else []


def run(program: ReactiveProgram, options: argparse.Namespace, extension: CheckExtension) -> "Optional[Verification]":
    """Verify the program, where that is asked for; raises ProgramError where it cannot be."""
    if options.verify is None:
        return None
    from rosoclingo.checking.verifying.verification import verify  # noqa: PLC0415 much to load, and rarely asked for

    if not program.declares_external("_request", 2):
        raise ProgramError([_fault("the program takes no goals", "declare #external _request/2.")])
    facts = tuple(options.fact)
    strange = [one for one in facts if one != "none" and one not in {s.name for s in program.external_signatures}]
    if strange:
        raise ProgramError([_fault(f"{strange[0]} is no external of the program", "give the name, as in _blocked")])
    reasons, kinds = extension.reasons(), extension.requests(program)
    selection = EventSelection(tuple(map(_goal, options.goal)), facts, reasons, options.each, kinds)
    plans = not options.one_plan
    limits = VerifyLimits(options.verify, options.together, options.steps, options.late, options.early, plans)
    skipped = frozenset(map(DefectKind, options.skip))
    try:
        return verify(program, selection, limits, options.verify_seconds, skipped)
    except (SolverError, RuntimeError, ProgressionError) as error:
        raise ProgramError([_fault(f"the program cannot be verified: {error}")]) from None


def _goal(text: str) -> Symbol:
    from rosoclingo.reasoning.goals import GoalError, read_goal  # noqa: PLC0415 for this option alone

    try:
        return read_goal(text.strip().rstrip("."))
    except GoalError as error:
        raise ProgramError([_fault(str(error))]) from None


def _fault(message: str, mend: str = "") -> Fault:
    return Fault("--verify", 0, 0, message, mend)


def _quoted(text: str) -> str:
    return '"{}"'.format(text.replace("\\", "\\\\").replace('"', '\\"'))
