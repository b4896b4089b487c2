"""Reactive logic programs: loading, checks, and analyses of their rules."""

from functools import cached_property
from pathlib import Path
from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set, Union

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError
from rosoclingo.oclingo.program import checks
from rosoclingo.oclingo.program.action_rules import ACTION, RUNNING
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.constants import check_given_values
from rosoclingo.oclingo.program.delays import Delays
from rosoclingo.oclingo.program.first_steps import TrialGrounding, redefined_by
from rosoclingo.oclingo.program.loaded_program import LoadedProgram
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.patterns import FAR, Pattern, are_apart, can_match, can_see_later
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.program.survey import Survey
from rosoclingo.oclingo.program.times import time_positions
from rosoclingo.oclingo.program.undefined import undefined_predicates
from rosoclingo.oclingo.progression.terms import Signature, parse_atom, signature_of

PathLike = Union[str, Path]


class ReactiveProgram(LoadedProgram):
    """A loaded program with the analyses of its rules for solvers and checks.

    Attributes:
        faults: the errors of a ``lenient`` program; other programs have none.
        survey: the statements by predicate.
        trial: the trial grounding of the first steps, None before it.

    """

    def __init__(
        self,
        sources: Sequence[Source],
        constants: Optional[Mapping[str, str]] = None,
        whole: bool = False,
        lenient: bool = False,
    ) -> None:
        """Load the texts in order; ``whole`` means that they contain all included files.

        Raises ProgramError with all faults that can be found without grounding. A ``lenient`` program is for inspection
        only: if it can be parsed, its errors are in ``faults``.
        """
        super().__init__(sources, constants or {}, whole)
        self.trial: Optional[TrialGrounding] = None
        self._trial_messages: List[Fault] = []
        self.survey = Survey(self.parts, self.values, self._directives.opened)
        self.faults = tuple(self._check())
        if self.faults and not lenient:
            raise ProgramError(self.faults)

    @classmethod
    def from_files(cls, files: Iterable[PathLike], constants: Optional[Mapping[str, str]] = None) -> "ReactiveProgram":
        """Load ``files`` in order; raise :class:`ProgramError` with the faults of all files."""
        return cls([Source.from_file(Path(file)) for file in files], constants)

    @classmethod
    def from_text(
        cls, text: str, name: str = "<text>", constants: Optional[Mapping[str, str]] = None
    ) -> "ReactiveProgram":
        """Load a single text; messages use ``name`` as file name."""
        return cls([Source(name, text)], constants)

    def declares_external(self, name: str, arity: int) -> bool:
        """Return whether the program declares an external of this name and arity."""
        return Signature(name, arity) in self.external_signatures

    @property
    def actions_go_on(self) -> bool:
        """Whether actions can go on while others end: the program declares ``_running(A,P,C)``."""
        return RUNNING in self.external_signatures

    def defines(self, name: str, arity: int) -> bool:
        """Return whether a rule has a head of this name and arity."""
        return Signature(name, arity) in self.head_signatures

    @cached_property
    def step_signatures(self) -> Set[Signature]:
        """The predicates that rules in cumulative and volatile parts define."""
        return {one.signature for part in self.parts if part.parameter for one in part.atoms if one.head}

    def delay_of(self, name: str, arity: int) -> Optional[int]:
        """Return the delay in cycles, 0 or 1, until such a fact can affect actions; None if it has no cycle.

        The cycle is the last argument; see :mod:`~rosoclingo.oclingo.program.delays`.
        """
        return self._delays.of(Signature(name, arity))

    @cached_property
    def _delays(self) -> Delays:
        return Delays(self.parts)

    def time_position(self, name: str, arity: int) -> Optional[int]:
        """Return the position of the cycle in such atoms or shown terms, None if they have none."""
        found = self._time_positions.get(Signature(name, arity))
        if found is None and self.delay_of(name, arity) is not None:
            return arity - 1
        return found

    def time_of(self, atom: clingo.Symbol) -> Optional[int]:
        """Return the cycle of an atom or shown term, None if it has none."""
        if atom.type is not clingo.SymbolType.Function:
            return None
        position = self.time_position(atom.name, len(atom.arguments))
        time = None if position is None else atom.arguments[position]
        return time.number if time is not None and time.type is clingo.SymbolType.Number else None

    @cached_property
    def _time_positions(self) -> Dict[Signature, int]:
        return time_positions(self.parts)

    def can_see(self, atoms: Iterable[clingo.Symbol], first: int, last: int) -> bool:
        """Return whether a rule of base or of steps ``first`` to ``last`` could have an instance with one of ``atoms``.

        Heads count only if the predicate is an open external.
        """
        return any(self._may("seen", atom, first, last) for atom in atoms)

    def can_mention(self, atom: clingo.Symbol, first: int) -> bool:
        """Return whether an instance from step ``first`` on could contain ``atom``; base counts for open externals."""
        return self._may("seen", atom, first, base=self.is_open_signature(atom))

    def can_declare(self, atom: clingo.Symbol, first: int, last: int = FAR) -> bool:
        """Return whether some step ``first`` to ``last`` could declare ``atom`` external."""
        return self._may("declared", atom, first, last, base=False)

    def is_declared_after(self, atom: clingo.Symbol, step: int) -> bool:
        """Return whether only steps after ``step`` could declare ``atom`` external."""
        known = self._may("declared", atom, self.first_step, step)
        return not known and self.can_declare(atom, step + 1)

    def can_define(self, atom: clingo.Symbol, first: int) -> bool:
        """Return whether base or some step from ``first`` on could define ``atom`` or declare it external."""
        return self.is_open_signature(atom) or any(self._may(one, atom, first) for one in ("defined", "declared"))

    def can_act(self, cycle: int, first: int) -> bool:
        """Return whether base or a step from ``first`` on could have an action of ``cycle``; never wrongly False."""
        atom = clingo.Function(ACTION.name, [clingo.Number(cycle)])  # like the patterns, without other arguments
        return ACTION in self.open_signatures or can_match(self._action_cycles, atom, first, FAR)

    @cached_property
    def _action_cycles(self) -> List[Pattern]:
        found = [one for part in self.parts for one in part.atoms if one.head and one.signature == ACTION]
        terms = [one.term.update(arguments=one.arguments[2:]) for one in found]
        return [Pattern(term, one.parameter, one.statement, self.values) for term, one in zip(terms, found)]

    @cached_property
    def steps_apart(self) -> bool:
        """Whether no step uses atoms of later steps, so that steps can be grounded together."""
        return not any(can_see_later(self._patterns["seen"], self._patterns[one]) for one in ("defined", "declared"))

    @cached_property
    def heads_apart(self) -> bool:
        """Whether each step defines its own atoms, so that clingo can search after the grounding of any step."""
        return all(map(are_apart, self._patterns["defined"].values()))

    @cached_property
    def _suspicious_heads(self) -> Set[Signature]:
        """The predicates of steps whose atoms base or another step could define again."""
        return {
            signature
            for signature, patterns in self._patterns["defined"].items()
            if any(one.parameter for one in patterns)
            and not (all(one.parameter for one in patterns) and are_apart(patterns))
        }

    @property
    def defines_externals(self) -> bool:
        """Whether a rule of the program can define an external."""
        return not self.external_signatures.isdisjoint(self.head_signatures)

    def declaring_step(self, atom: clingo.Symbol, steps: range) -> int:
        """Return the step, one of ``steps``, that declared the external ``atom``."""
        patterns = (one for one in self._patterns["declared"].get(signature_of(atom), ()) if one.parameter)
        found = (one.first_match(atom, steps[0], steps[-1]) for one in patterns)
        return min((step for step in found if step is not None), default=steps[0])

    @cached_property
    def signatures(self) -> Set[Signature]:
        """All predicates of the program."""
        return set().union(*self._patterns.values())

    @cached_property
    def head_signatures(self) -> Set[Signature]:
        """The predicates that rules define."""
        return set(self._patterns["defined"])

    @cached_property
    def external_signatures(self) -> Set[Signature]:
        """All predicates that ``#external`` statements declare."""
        return {*self._patterns["declared"], *self.open_signatures}

    @cached_property
    def dependents(self) -> Dict[Signature, Set[Signature]]:
        """For each predicate, those in the heads of the rules that contain it in a positive body literal."""
        found: Dict[Signature, Set[Signature]] = {}
        for part in self.parts:
            for statement, atoms in part.found:
                heads = {one.signature for one in atoms if one.head and statement.ast_type == ASTType.Rule}
                for one in atoms:
                    if one.positive:
                        found.setdefault(one.signature, set()).update(heads)
        return found

    @cached_property
    def optimizes(self) -> bool:
        """Whether there are ``#minimize`` statements."""
        return any(one.ast_type == ASTType.Minimize for part in self.parts for one in part.statements)

    @cached_property
    def _patterns(self) -> Dict[str, Dict[Signature, List[Occurrence]]]:
        """The atoms that statements use, declare external and define."""
        found: Dict[str, Dict[Signature, List[Occurrence]]] = {"seen": {}, "declared": {}, "defined": {}}
        for one in (one for part in self.parts for one in part.atoms):
            roles = ["declared" if one.declares else "defined"] if one.head else []
            roles += ["seen"] if not one.head or one.signature in self.open_signatures else []
            for role in roles:
                found[role].setdefault(one.signature, []).append(one)
        return found

    def _may(self, role: str, atom: clingo.Symbol, first: int, last: int = FAR, base: bool = True) -> bool:
        return can_match(self._patterns[role].get(signature_of(atom), ()), atom, first, last, base)

    def _check(self) -> List[Fault]:
        """Return all faults that show in the program or in its first steps; add warnings to the remarks."""
        faults = checks.wrong_arities(self.parts) + self._load_faults
        odd = checks.missing_parts(self.parts)
        late = checks.late_externals(self.survey)
        if checks.uses_keywords(self.parts):
            faults += [one for one in odd if "volatile part" not in one.message] + late
            odd, late = [one for one in odd if one not in faults], []
        self.remarks += [
            *odd,
            *late,
            *undefined_predicates(self.survey),
            *check_given_values(self.survey, self.constants),
        ]
        if not faults and self._suspicious_heads:
            faults += self._ground_first_steps()
        return faults

    def redefinition_of(self, atom: str) -> List[Fault]:
        """Return a fault for each rule that could be the second step's definition of ``atom``."""
        try:
            named = {signature_of(parse_atom(atom))}
        except ProgressionError:  # clingo did not name the atom
            named = self._suspicious_heads
        found = redefined_by(self.parts, atom or "an atom", named)
        return found or [Fault("<program>", 0, 0, f"redefinition: {atom} is defined twice", kind="redefinition")]

    def first_step_messages(self) -> List[Fault]:
        """Return clingo's messages about the first steps; ground these steps if necessary."""
        if self.trial is None and not self.faults:
            self._ground_first_steps()
        return self._trial_messages

    def _ground_first_steps(self) -> List[Fault]:
        """Ground the first steps, record clingo's messages and return the faults."""
        messages = Messages()
        try:
            self.trial = TrialGrounding(self._control(messages), self.first_step)
        except RuntimeError as error:
            return messages.faults(error, self.parameter_at)
        found = messages.new_remarks(self.parameter_at)
        self._trial_messages = [one for one in found if one not in self.remarks]
        redefined = self.trial.redefined
        return [fault for one in sorted(redefined) for fault in redefined_by(self.parts, redefined[one], {one})]
