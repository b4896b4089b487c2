"""Trial plans: the plan of a program for a request, or an explanation why there is none."""

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
from rosoclingo.oclingo.solving.results import SolveOutcome
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.history import Plan
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Stop
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.relevance import RelevanceAnalysis


@dataclass(frozen=True)
class TrialPlan:
    """The result of a request or of an update of the stream.

    Attributes:
        name: the request as it was written, or the step of the update.
        answer: the shown atoms of the plan; None if there is no plan.
        horizon: the horizon of the plan.
        why: the explanation if there is no plan.
        fault: an error, or why the result is unknown; else empty.

    """

    name: str
    answer: Optional[FrozenSet[clingo.Symbol]] = None
    horizon: int = 0
    why: Optional[WhyNot] = None
    fault: str = ""

    def text(self, width: int) -> str:
        """Return the result as text; a plan is a table over time."""
        if self.fault:
            return f"{self.name}: {self.fault}\n"
        if self.answer is None:
            return f"{self.name}: {'' if self.why is None else self.why.text()}"
        actions = [atom for atom in self.answer if is_action(atom)]
        last = Plan.from_atoms(actions, self.horizon).last_cycle
        table = format_answer(actions or self.answer, self.horizon + 1, width)
        return f"{self.name}: {f'a plan up to step {last}' if actions else 'nothing to do'}\n{table}"

    def to_message(self) -> Dict[str, Any]:
        """Return the result as a value for JSON."""
        return {
            "name": self.name,
            "plan": None if self.answer is None else sorted(map(str, self.answer)),
            "horizon": self.horizon,
            "why": None if self.why is None else self.why.to_message(),
            "fault": self.fault,
        }


class Trials:
    """Plans requests of a program, each one independently after the same stream.

    Plans are shortest ones of at most ``steps`` further steps; ``seconds`` limits each search.
    """

    def __init__(self, program: ReactiveProgram, steps: int = TRIAL_STEPS, seconds: float = TRIAL_SECONDS) -> None:
        self._program, self._steps, self._seconds = program, steps, seconds
        self._solver = PlanSolver(program)
        self._relevance = RelevanceAnalysis.of(program)
        self._played = False

    def play(self, updates: Iterable[StreamUpdate]) -> List[TrialPlan]:
        """Play updates, and return the results of those without an answer."""
        found: List[TrialPlan] = []
        for update in updates:
            bounded = replace(update, bound=self._steps) if update.bound is None else update
            trial = self._try(bounded, f"update of step {self._solver.step if update.step is None else update.step}")
            self._played = True
            if trial.answer is None:
                found.append(trial)
        return found

    def request(self, text: str) -> TrialPlan:
        """Plan a request, then restore the stream. Raises ProgramError if ``text`` is not a request."""
        log = self._solver.log
        step = log.step + 1 if self._played else log.step
        past: Tuple[Item, ...] = (CloseCycles(log.step, log.step),) if self._played else ()
        facts = self._facts(text, step)
        sent = [one for one in facts if one.match("_request", 2)]
        invalid = next((one for one in sent if not self._relevance.is_relevant(one)), None)
        if invalid is not None:
            return TrialPlan(text, fault=f"no rule of the program can see it: {self._relevance.advice(invalid)}")
        try:
            return self._try(StreamUpdate(step, self._steps, (*past, *map(Statement, facts))), text)
        finally:
            self._solver.restore(log)

    def samples(self, kinds: Kinds = ()) -> List[TrialPlan]:
        """Plan requests of each kind, up to the first one with actions; the default kinds are those of the rules."""
        return [self._sample(texts) for texts in kinds or sample_requests(self._program)]

    def _sample(self, texts: Iterable[str]) -> TrialPlan:
        stopped = self._clock()
        trial = TrialPlan("a sample", fault="no request can be formed from the names in the facts")
        for text in texts:
            trial = self.request(text)
            if any(map(is_action, trial.answer or ())) or stopped():
                break
        return trial

    def _facts(self, text: str, step: int) -> List[clingo.Symbol]:
        """Return the facts of a request; facts of an external of the program are used as they are."""
        remedy = "write a term such as goal(office1,office2,1), or a fact of an external of the program"
        try:
            update = parse_update(f"{text.strip().rstrip('.')}.\n#endstep.")
        except ProgressionError as error:
            raise ProgramError([Fault(f"--plan {text!r}", 0, 0, error.message, remedy)]) from None
        heads = [item.head if isinstance(item, Statement) and not item.body else None for item in update.items]
        terms = [head for head in heads if head is not None]
        if not terms or len(terms) < len(heads) or update.step is not None:
            raise ProgramError([Fault(f"--plan {text!r}", 0, 0, "not a request", remedy)])
        return [self._fact(term, step, text) for term in terms]

    def _fact(self, term: clingo.Symbol, step: int, text: str) -> clingo.Symbol:
        if signature_of(term) in self._program.external_signatures:
            return term
        if not self._program.declares_external("_request", 2):
            message = f"the program takes no requests, and {signature_of(term)} is not an external"
            raise ProgramError([Fault(f"--plan {text!r}", 0, 0, message, "declare #external _request/2.")])
        cycle = step if term.match("cancel", 1) else step + 1
        return clingo.Function("_request", [term, clingo.Number(cycle)])

    def _try(self, update: StreamUpdate, name: str) -> TrialPlan:
        before = self._solver.log
        try:
            result = self._solver.update(update, self._clock())
            if result.outcome is SolveOutcome.SATISFIABLE:
                ignored = (text for text in result.warnings if "has not been declared external" in text)
                answer = result.until_horizon(self._program).answers[-1]
                return TrialPlan(name, answer, result.horizon, fault=next(ignored, ""))
            if result.outcome is SolveOutcome.INTERRUPTED:
                return TrialPlan(name, fault=f"no plan was found in {self._seconds:g} s")
            stream = Stream(before, update, (update.bound or 0))
            return TrialPlan(name, why=explain(self._program, stream, self._clock()))
        except UndecidedError:
            return TrialPlan(name, fault=f"no plan; the reason was not found in {self._seconds:g} s")
        except SolverError as error:
            return TrialPlan(name, fault=str(error))

    def _clock(self) -> Stop:
        """Return a stop that ends a search after its time limit."""
        end = time.monotonic() + self._seconds
        return lambda: time.monotonic() >= end
