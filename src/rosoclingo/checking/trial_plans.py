"""Plans on trial: what a program would do about requests, and why nothing where there is no plan."""

import time
from dataclasses import dataclass, replace
from typing import Any, Dict, FrozenSet, Iterable, List, Optional, Tuple

import clingo

from rosoclingo.checking.extension import Kinds
from rosoclingo.checking.sample_requests import sample_requests
from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError, SolverError
from rosoclingo.oclingo.program.action_rules import is_action
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import CloseCycles, Item, Statement, StreamUpdate
from rosoclingo.oclingo.service.arguments import TRIAL_SECONDS, TRIAL_STEPS
from rosoclingo.oclingo.service.table import format_answer
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.history import Plan
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Stop
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.hearing import Hearing


@dataclass(frozen=True)
class TrialPlan:
    """What came of a request, or of an update of the stream.

    Attributes:
        name: the request as it was written, or which update it was.
        answer: the shown atoms of the plan, None where there is none.
        horizon: that of the plan.
        why: why there is none.
        fault: why it is not known, empty where it is.

    """

    name: str
    answer: Optional[FrozenSet[clingo.Symbol]] = None
    horizon: int = 0
    why: Optional[WhyNot] = None
    fault: str = ""

    def text(self, width: int) -> str:
        """Return it for people; a plan is a table over time."""
        if self.fault:
            return f"{self.name}: {self.fault}\n"
        if self.answer is None:
            return f"{self.name}: {'' if self.why is None else self.why.text()}"
        actions = [atom for atom in self.answer if is_action(atom)]
        last = Plan.from_atoms(actions, self.horizon).last_cycle
        table = format_answer(actions or self.answer, self.horizon + 1, width)
        return f"{self.name}: {f'a plan up to step {last}' if actions else 'nothing to do'}\n{table}"

    def to_message(self) -> Dict[str, Any]:
        """Return it as a plain value that JSON knows."""
        return {
            "name": self.name,
            "plan": None if self.answer is None else sorted(map(str, self.answer)),
            "horizon": self.horizon,
            "why": None if self.why is None else self.why.to_message(),
            "fault": self.fault,
        }


class Trials:
    """Tries requests on a program, each on its own, after a stream.

    Plans are shortest, and have at most ``steps`` steps beyond the present one.
    """

    def __init__(self, program: ReactiveProgram, steps: int = TRIAL_STEPS, seconds: float = TRIAL_SECONDS) -> None:
        self._program, self._steps, self._seconds = program, steps, seconds
        self._solver = PlanSolver(program)
        self._hearing = Hearing.of(program)
        self._played = False

    def play(self, updates: Iterable[StreamUpdate]) -> List[TrialPlan]:
        """Take updates, and return what came of those that have no answer."""
        found: List[TrialPlan] = []
        for update in updates:
            bounded = replace(update, bound=self._steps) if update.bound is None else update
            trial = self._try(bounded, f"update of step {self._solver.step if update.step is None else update.step}")
            self._played = True
            if trial.answer is None:
                found.append(trial)
        return found

    def request(self, text: str) -> TrialPlan:
        """Try a request; the stream is as it was before then. Raises ProgramError where it is none."""
        log = self._solver.log
        step = log.step + 1 if self._played else log.step
        past: Tuple[Item, ...] = (CloseCycles(log.step, log.step),) if self._played else ()
        facts = self._facts(text, step)
        unheard = next((one for one in facts if one.match("_request", 2) and not self._hearing.hears(one)), None)
        if unheard is not None:
            return TrialPlan(text, fault=f"no rule of the program can see it: {self._hearing.advice(unheard)}")
        try:
            return self._try(StreamUpdate(step, self._steps, (*past, *map(Statement, facts))), text)
        finally:
            self._solver.restore(log)

    def samples(self, kinds: Kinds = ()) -> List[TrialPlan]:
        """Try requests of each kind, up to the first with something to do; without kinds those of the rules."""
        return [self._sample(texts) for texts in kinds or sample_requests(self._program)]

    def _sample(self, texts: Iterable[str]) -> TrialPlan:
        clock, trial = self._clock(), TrialPlan("a sample", fault="no request could be made of the names in the facts")
        for text in texts:
            trial = self.request(text)
            if any(map(is_action, trial.answer or ())) or clock():
                break
        return trial

    def _facts(self, text: str, step: int) -> List[clingo.Symbol]:
        """Return the facts that a request stands for: those of an external of the program are taken as they are."""
        mend = "write a term as in goal(office1,office2,1), or a fact about an external of the program"
        try:
            update = parse_update(f"{text.strip().rstrip('.')}.\n#endstep.")
        except ProgressionError as error:
            raise ProgramError([Fault(f"--plan {text!r}", 0, 0, error.message, mend)]) from None
        heads = [item.head if isinstance(item, Statement) and not item.body else None for item in update.items]
        terms = [head for head in heads if head is not None]
        if not terms or len(terms) < len(heads) or update.step is not None:
            raise ProgramError([Fault(f"--plan {text!r}", 0, 0, "no request", mend)])
        return [self._fact(term, step, text) for term in terms]

    def _fact(self, term: clingo.Symbol, step: int, text: str) -> clingo.Symbol:
        if signature_of(term) in self._program.external_signatures:
            return term
        if not self._program.declares_external("_request", 2):
            message = f"the program takes no requests, and {signature_of(term)} is no external of it"
            raise ProgramError([Fault(f"--plan {text!r}", 0, 0, message, "declare #external _request/2.")])
        cycle = step if term.match("cancel", 1) else step + 1
        return clingo.Function("_request", [term, clingo.Number(cycle)])

    def _try(self, update: StreamUpdate, name: str) -> TrialPlan:
        before = self._solver.log
        try:
            result = self._solver.update(update, self._clock())
            if result.outcome is SolveOutcome.SATISFIABLE:
                return TrialPlan(name, result.answers[-1], result.horizon, fault=_ignored(result))
            if result.outcome is SolveOutcome.INTERRUPTED:
                return TrialPlan(name, fault=f"no plan was found in {self._seconds:g} s")
            stream = Stream(before, update, (update.bound or 0))
            return TrialPlan(name, why=explain(self._program, stream, self._clock()))
        except UndecidedError:
            return TrialPlan(name, fault=f"no plan; it was not found out in {self._seconds:g} s why")
        except SolverError as error:
            return TrialPlan(name, fault=str(error))

    def _clock(self) -> Stop:
        """Return a stop after the seconds of a search."""
        end = time.monotonic() + self._seconds
        return lambda: time.monotonic() >= end


def _ignored(result: SolveResult) -> str:
    """Return why a request was not taken at all."""
    return next((text for text in result.warnings if "has not been declared external" in text), "")
