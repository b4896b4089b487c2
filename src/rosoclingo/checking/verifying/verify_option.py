"""The option ``--verify`` of the command ``check``."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, List, Optional

from clingo import String, Symbol

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
    "search for a stream of at most DEPTH events (goals, cancels, facts, failures) that breaks the program "
    f"(default: {_DEPTH})"
)
_SECONDS = "limit of processor time for the verification (default: %(default)g)"
_GOAL = (
    "a goal that can occur, such as goal(office1,office2,1); can be repeated (default: goals that have plans with "
    "actions, from --orders or else from the program's rules)"
)
_FACT = "name of the facts that can occur, such as _blocked; can be repeated; none: no facts (default: all externals)"
_EACH = "greatest number of goals of each kind, and of facts of each name (default: %(default)s)"
_LATE = "greatest number of cycles that facts are late (default: %(default)s)"
_EARLY = "greatest number of cycles that facts are early (default: %(default)s)"
_TOGETHER = "greatest number of events between two updates (default: %(default)s)"
_NEVER = "a state that must never occur at a step t, as the body of a rule; can be repeated"
_SKIP = "a kind of defects to ignore; can be repeated: " + ", ".join(one.value for one in DefectKind)


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
        ("--one-plan", {"action": "store_true"}, "explore only the plans that the solver finds, not all shortest ones"),
        ("--never", {"action": "append", "default": [], "metavar": "BODY"}, _NEVER),
        ("--skip", {"action": "append", "default": [], "metavar": "KIND", "choices": kinds}, _SKIP),
    ):
        add(name, help=words, **settings)  # type: ignore[arg-type]


def sources(options: argparse.Namespace) -> List[Source]:
    """Return the rules for the forbidden states of ``--never``."""
    bodies = [body.strip().rstrip(".") for body in options.never]
    rules = [f"_never({String(body)},t) :- {body}.\n" for body in bodies]
    return [Source("--never", "#program cumulative(t).\n" + "".join(rules), Path())] if rules else []


def run(program: ReactiveProgram, options: argparse.Namespace, extension: CheckExtension) -> "Optional[Verification]":
    """Verify the program if ``--verify`` is given; raises ProgramError if it cannot be verified."""
    if options.verify is None:
        return None
    from rosoclingo.checking.verifying.verification import verify  # noqa: PLC0415 slow to load, and rarely used

    if not program.declares_external("_request", 2):
        raise ProgramError([_fault("the program takes no goals", "declare #external _request/2.")])
    facts = tuple(options.fact)
    unknown = [one for one in facts if one != "none" and one not in {s.name for s in program.external_signatures}]
    if unknown:
        raise ProgramError([_fault(f"{unknown[0]} is not an external of the program", "write a name such as _blocked")])
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
    from rosoclingo.reasoning.goals import GoalError, read_goal  # noqa: PLC0415 only this option needs it

    try:
        return read_goal(text.strip().rstrip("."))
    except GoalError as error:
        raise ProgramError([_fault(str(error))]) from None


def _fault(message: str, remedy: str = "") -> Fault:
    return Fault("--verify", 0, 0, message, remedy)
