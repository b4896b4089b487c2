"""Trial grounding of the first steps, to find heads that two steps define and to collect clingo's messages."""

from typing import Dict, List, Optional, Sequence, Set

import clingo
from clingo.backend import Observer

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.progression.terms import Signature, signature_of

_TRIAL_STEPS = 3
_TRIAL_SECONDS = 0.5
_TRIAL_RULES = 50_000  # a fraction of a second of grounding


class _TrialTooLargeError(Exception):
    """A trial grounding exceeds its limit of rules."""


class _Heads(Observer):
    """Records which atoms rules define; aborts groundings with too many rules, which might not terminate."""

    def __init__(self) -> None:
        self.fresh: Set[int] = set()
        self._left = _TRIAL_RULES

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record the head of a rule; raise _TrialTooLargeError if there are too many rules."""
        self._left -= 1
        if self._left < 0:
            raise _TrialTooLargeError
        self.fresh.update(head)


class TrialGrounding:
    """Grounds the first steps of a program; stops early if there is too much to ground.

    Attributes:
        redefined: for each predicate that two steps define, one of these atoms.
        last: the last grounded step, None if the program is too large.

    """

    def __init__(self, control: clingo.Control, first: int) -> None:
        """Ground base and the steps from ``first`` on ``control``, into which the program is loaded.

        Raises RuntimeError like clingo; details go to the control's logger.
        """
        self.redefined: Dict[Signature, str] = {}
        self.last: Optional[int] = None
        self._control = control
        observer = _Heads()
        control.register_observer(observer)
        twice: Set[int] = set()
        try:
            control.ground([("base", [])])
            defined = set(observer.fresh)
            for step in range(first, first + _TRIAL_STEPS):
                observer.fresh.clear()
                control.ground([(name, [clingo.Number(step)]) for name in ("cumulative", "volatile")])
                twice |= observer.fresh & defined
                defined |= observer.fresh
        except _TrialTooLargeError:
            return  # no findings for large programs; the real grounding reports their errors
        self.last = step
        for one in control.symbolic_atoms if twice else ():
            if one.literal in twice:
                self.redefined.setdefault(signature_of(one.symbol), str(one.symbol))

    def demands(self, signature: Signature) -> bool:
        """Return whether each answer has an atom of the predicate whose last argument is the last step.

        The answers are without facts and without the goals of a plan. Return False if there is no answer at all, or if
        the search takes too long.
        """
        if self.last is None:
            return False
        atoms = self._control.symbolic_atoms.by_signature(signature.name, signature.arity, signature.positive)
        step = clingo.Number(self.last)
        absent = [-one.literal for one in atoms if one.symbol.arguments[-1] == step]
        return self._has_answer(absent) is False and self._has_answer([]) is True

    def _has_answer(self, assumptions: Sequence[int]) -> Optional[bool]:
        """Return whether there is an answer, None if the search takes too long."""
        self._control.configuration.solve.opt_mode = "ignore"  # type: ignore[union-attr]
        with self._control.solve(assumptions, async_=True) as handle:
            done = handle.wait(_TRIAL_SECONDS)
            handle.cancel()
            return handle.get().satisfiable if done else None


def redefined_by(parts: Sequence[Part], name: str, signatures: Set[Signature]) -> List[Fault]:
    """Return a fault for each rule of a step whose head is of ``signatures``; ``name`` is the redefined atom."""
    message = f"redefinition: {name} is defined by the rules of two steps"
    remedy = "give the head the step, like p(t), or move the rule to base"
    return [
        one.fault("redefinition", message, remedy)
        for part in parts
        for one in part.atoms
        if one.defines and one.parameter and one.signature in signatures
    ]
