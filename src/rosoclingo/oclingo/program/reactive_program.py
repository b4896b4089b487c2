"""Reactive logic programs: loaded from files, put into clingo's form, and known by their parts and externals."""

import json
from functools import cached_property, partial
from hashlib import sha256
from pathlib import Path
from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple, Union

import clingo
from clingo.ast import ASTType, ProgramBuilder

from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError
from rosoclingo.oclingo.program import checks
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN, closing_text, cycle_alone
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.constants import constant_values, given_values
from rosoclingo.oclingo.program.delays import Delays
from rosoclingo.oclingo.program.directives import Directives
from rosoclingo.oclingo.program.first_steps import Trial, redefined_by, suspicious_heads
from rosoclingo.oclingo.program.parts import GUARD, OpenPart, Part, open_part, rewrite
from rosoclingo.oclingo.program.patterns import FAR, Pattern, are_apart, may_match, may_see_later
from rosoclingo.oclingo.program.return_rules import ReturnRules, return_rules
from rosoclingo.oclingo.program.signatures import Dependencies, rule_edges
from rosoclingo.oclingo.program.sources import Source, parse_constants, read_sources, statement_at
from rosoclingo.oclingo.program.survey import Survey
from rosoclingo.oclingo.program.times import time_positions
from rosoclingo.oclingo.program.undefined import undefined
from rosoclingo.oclingo.progression.terms import Signature, parse_atom, signature_of

PathLike = Union[str, Path]


class ReactiveProgram:
    """A reactive logic program: base, cumulative and volatile part, externals, and what the solver has to know of them.

    Attributes:
        sources: the texts that it was made of.
        texts: these and all that they include, in order.
        constants: values of ``#const`` names that were given from outside, as symbols.
        values: the values of all constants.
        first_step: the first grounded step (1 unless ``#iinit`` says less).
        windows: the distinct lengths w of ``#volatile t : w.``, in steps.
        forgets: the ``#forget t : term.`` directives.
        open_signatures: the predicates of ``#external p/n.``
        external_signatures: all predicates that some external declares.
        signatures: all predicates that the program mentions.
        advises: whether ``#heuristic`` statements tell the solver where to look first.
        shows: the predicates of ``#show p/n.``
        return_rules: rules that tell what returns bear on; None where they can't.
        faults: why it cannot be used; there are some where it is ``lenient`` alone.
        remarks: what is odd but usable.
        survey: its statements by predicates.
        trial: its ground first steps, None before they are ground.

    """

    def __init__(
        self,
        sources: Sequence[Source],
        constants: Optional[Mapping[str, str]] = None,
        whole: bool = False,
        lenient: bool = False,
    ) -> None:
        """Take the texts in order; with ``whole`` all that they include is among them.

        Raises ProgramError with all faults that can be found without grounding; a ``lenient`` one, which is to be
        looked at alone, has those in its ``faults`` that do not keep it from being read.
        """
        self.sources = tuple(sources)
        self.constants: Dict[str, clingo.Symbol] = parse_constants(constants or {})
        self._directives = Directives()
        self.remarks: List[Fault] = []
        self.trial: Optional[Trial] = None
        self._said: Optional[List[Fault]] = None  # what clingo says of the first steps, once they have been ground
        parsed = read_sources(sources, self._directives, self.remarks, whole)
        self.texts = tuple(one.source for one in parsed)
        self._known_delays: Dict[Signature, Optional[int]] = {}
        self.parts: List[Part] = rewrite(parsed, self._directives)
        opened = {one.signature for one in self._directives.opened}
        self.parts += rewrite(read_sources([closing_text(self.parts, opened)], Directives(), []), Directives())
        self._collect()
        self.faults = tuple(self._check())
        if self.faults and not lenient:
            raise ProgramError(self.faults)
        self._collect_patterns()

    @classmethod
    def from_files(cls, files: Iterable[PathLike], constants: Optional[Mapping[str, str]] = None) -> "ReactiveProgram":
        """Load ``files`` in order; raise :class:`ProgramError` naming each file that cannot be read or used."""
        return cls([Source.from_file(Path(file)) for file in files], constants)

    @classmethod
    def from_text(
        cls, text: str, name: str = "<text>", constants: Optional[Mapping[str, str]] = None
    ) -> "ReactiveProgram":
        """Take one text; ``name`` stands for the file in messages."""
        return cls([Source(name, text)], constants)

    @property
    def warnings(self) -> List[str]:
        """What is odd but usable, as text."""
        return [str(one) for one in self.remarks]

    @property
    def fingerprint(self) -> str:
        """What programs of the same texts and constants share, wherever their files lie: a SHA-256 in hexadecimal."""
        constants = sorted((name, str(value)) for name, value in self.constants.items())
        return sha256(json.dumps([[one.text for one in self.texts], constants]).encode("ascii")).hexdigest()

    def declares_external(self, name: str, arity: int) -> bool:
        """Tell whether some external of this name and arity is declared."""
        return Signature(name, arity) in self.external_signatures

    def defines(self, name: str, arity: int) -> bool:
        """Tell whether some rule has a head of this name and arity."""
        return Signature(name, arity) in self.head_signatures

    @cached_property
    def step_signatures(self) -> Set[Signature]:
        """The predicates that rules in the parts of steps define."""
        return {one.signature for part in self.parts if part.parameter for _, one in part.atoms if one.head}

    @property
    def tells_plainly(self) -> bool:
        """Whether an answer tells its actions, no returns, and by rules of its own what returns bear on.

        Answers are one plan then, and neither the best nor some of many.
        """
        shows = ACTION in self.shows and RETURN not in self.shows
        return shows and not self.optimizes and self.return_rules is not None

    def delay_of(self, name: str, arity: int) -> Optional[int]:
        """Return after how many cycles (0 or 1) such a fact bears on actions; None where it has no cycle.

        The cycle is the last argument; see :mod:`~rosoclingo.oclingo.program.delays`.
        """
        signature = Signature(name, arity)
        if signature not in self._known_delays:
            self._known_delays[signature] = self._delays.of(signature)
        return self._known_delays[signature]

    @cached_property
    def _delays(self) -> Delays:
        return Delays(self.parts, self.values)

    def time_position(self, name: str, arity: int) -> Optional[int]:
        """Return which argument of such an atom, or of such a term that is shown, is its cycle; None where none is."""
        found = self._time_positions.get(Signature(name, arity))
        if found is None and self.delay_of(name, arity) is not None:
            return arity - 1
        return found

    @cached_property
    def _time_positions(self) -> Dict[Signature, int]:
        return time_positions(self.parts, self.values)

    def load_into(self, control: clingo.Control, foresees: bool = False) -> None:
        """Add all statements to ``control``, with those that tell what returns bear on where it ``foresees``.

        Raises RuntimeError as clingo does, details go to its logger.
        """
        with ProgramBuilder(control) as builder:
            for part in self.parts:
                builder.add(part.header.ast)
                for statement in part.statements:
                    builder.add(statement.ast)
        for opened in self._open_parts.values():
            control.add(*opened)
        for asking in self.return_rules.texts if foresees and self.return_rules is not None else ():
            control.add(*asking)

    def open_part(self, atom: clingo.Symbol, fact: bool) -> Tuple[str, List[clingo.Symbol]]:
        """Return the part to ground, with its arguments, that makes ``atom`` an external or a fact."""
        return self._open_parts[signature_of(atom), fact].name, atom.arguments

    def guard(self, window: int, step: int) -> clingo.Symbol:
        """Return the guard of the volatile instance of ``step`` with length ``window``."""
        return clingo.Function(GUARD, [clingo.Number(window), clingo.Number(step)])

    def arguments(self) -> List[str]:
        """Return clingo's command line arguments for every control that loads the program.

        They set the constants, enable ``#heuristic`` if there is one, and try false first for open atoms, so that
        plans hold no useless actions. Equivalence preprocessing is off: over several solve calls of one control, clasp
        3.3.10 to 3.4.0 (clingo 5.7.0 to 5.8.3) loses facts and answers with it.
        """
        heuristic = ["--heuristic=Domain"] if self.advises else []
        constants = (f"-c{name}={value}" for name, value in self.constants.items())
        return ["-Wno-atom-undefined", "--sign-def=neg", "--eq=0", *heuristic, *constants]

    def may_see(self, atoms: Iterable[clingo.Symbol], first: int, last: int) -> bool:
        """Tell whether a rule of base or steps ``first`` to ``last`` could have an instance with one of ``atoms``.

        Heads count for open externals alone.
        """
        for atom in atoms:  # noqa: SIM110 (a loop takes half the time)
            if may_match(self._patterns.get(signature_of(atom), ()), atom, first, last):
                return True
        return False

    def may_mention(self, atom: clingo.Symbol, first: int) -> bool:
        """Tell whether ``atom``, true before, matters to the steps from ``first`` on (or to base, if it can see it)."""
        patterns = self._patterns.get(signature_of(atom), ())
        return may_match(patterns, atom, first, FAR, base=self.is_open_signature(atom))

    def is_open_signature(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom`` is of a signature that ``#external p/n.`` opens."""
        return signature_of(atom) in self.open_signatures

    def may_declare(self, atom: clingo.Symbol, first: int, last: int = FAR) -> bool:
        """Tell whether some step ``first`` to ``last`` could declare ``atom`` external."""
        return may_match(self._declarations.get(signature_of(atom), ()), atom, first, last, base=False)

    def is_declared_after(self, atom: clingo.Symbol, step: int) -> bool:
        """Whether steps after ``step`` may declare ``atom`` external, and base and the steps up to it do not."""
        declarations = self._declarations.get(signature_of(atom), ())
        known = may_match(declarations, atom, self.first_step, step)
        return not known and may_match(declarations, atom, step + 1, FAR, base=False)

    def may_define(self, atom: clingo.Symbol, first: int) -> bool:
        """Tell whether base or some step from ``first`` on could define ``atom``, or declare it external."""
        signature = signature_of(atom)
        defining = (one.get(signature, ()) for one in (self._heads, self._declarations))
        return signature in self.open_signatures or any(may_match(one, atom, first, FAR) for one in defining)

    def may_act(self, cycle: int, first: int) -> bool:
        """Tell whether base or some step from ``first`` on could have an action of ``cycle``; never wrongly False."""
        atom = clingo.Function(ACTION.name, [clingo.Number(cycle)])
        return may_match(self._action_cycles, atom, first, FAR) or ACTION in self.open_signatures

    @cached_property
    def steps_apart(self) -> bool:
        """Whether no step sees what a later one defines, so that steps may as well be ground together."""
        return not any(may_see_later(self._patterns, one) for one in (self._heads, self._declarations))

    @cached_property
    def heads_apart(self) -> bool:
        """Whether each step defines atoms of its own, so that clingo may search between any two of them."""
        return all(map(are_apart, self._heads.values()))

    @property
    def defines_externals(self) -> bool:
        """Whether a rule of the program may define an external."""
        return not self.external_signatures.isdisjoint(self.head_signatures)

    def declaring_step(self, atom: clingo.Symbol, steps: range) -> int:
        """Return which of ``steps``, where it was declared external, declared ``atom``."""
        patterns = (one for one in self._declarations.get(signature_of(atom), ()) if one.parameter)
        found = (one.first_match(atom, steps[0], steps[-1]) for one in patterns)
        return min((step for step in found if step is not None), default=steps[0])

    def _collect(self) -> None:
        """Gather signatures and dependencies from the statements."""
        self.dependencies = Dependencies()
        self.signatures: Set[Signature] = set()
        self.head_signatures: Set[Signature] = set()
        self.open_signatures = {one.signature for one in self._directives.opened}
        self.external_signatures = set(self.open_signatures)
        self._open_parts: Dict[Tuple[Signature, bool], OpenPart] = {
            (signature, fact): open_part(signature, fact)
            for signature in sorted(self.open_signatures)
            for fact in (False, True)
        }
        self.return_rules: Optional[ReturnRules] = None
        self.optimizes = self.advises = False
        self.shows: Set[Signature] = set()
        for part in self.parts:
            for statement, found in part.found:
                self.optimizes |= statement.ast_type == ASTType.Minimize
                self.advises |= statement.ast_type == ASTType.Heuristic
                if statement.ast_type == ASTType.ShowSignature:
                    self.shows.add(Signature(statement.name, statement.arity, bool(statement.positive)))
                self.dependencies.add(*rule_edges(statement, found))
            for statement, one in part.atoms:
                self.signatures.add(one.signature)
                if one.head:
                    external = statement.ast_type == ASTType.External
                    (self.external_signatures if external else self.head_signatures).add(one.signature)

    def _collect_patterns(self) -> None:
        """Gather what the program could see and declare; its constants have values by now."""
        self._patterns: Dict[Signature, List[Pattern]] = {}
        self._declarations: Dict[Signature, List[Pattern]] = {}
        self._heads: Dict[Signature, List[Pattern]] = {}
        self._action_cycles: List[Pattern] = []
        for part in self.parts:
            for statement, one in part.atoms:
                pattern = Pattern(one.term, part.parameter, statement, self.values)
                if one.head and one.signature == ACTION:
                    alone = cycle_alone(one.term)
                    self._action_cycles.append(Pattern(alone, part.parameter, statement, self.values))
                if one.head:
                    external = statement.ast_type == ASTType.External
                    table = self._declarations if external else self._heads
                    table.setdefault(one.signature, []).append(pattern)
                if not one.head or one.signature in self.open_signatures:
                    self._patterns.setdefault(one.signature, []).append(pattern)
        self.return_rules = return_rules(self.parts, self.values)

    def _control(self, messages: Messages) -> clingo.Control:
        """Return a control with the program loaded; raise :class:`ProgramError` where clingo won't take it."""
        control = clingo.Control(self.arguments(), logger=messages.log)
        try:
            self.load_into(control)
            control.ground([("__oclingo_no_part", [])])  # now clingo looks for unsafe variables
        except RuntimeError as error:
            told = partial(statement_at, self.texts)
            raise ProgramError(messages.faults(error, self.parameter_at, told)) from None
        return control

    def parameter_at(self, file: str, line: int) -> str:
        """Return the step parameter of the part that a line stands in, ``t`` where that is not known."""
        for part in self.parts:
            for statement in part.statements if part.parameter else ():
                begin, end = statement.location.begin, statement.location.end
                if begin.filename == file and begin.line <= line <= end.line:
                    return part.parameter
        return "t"

    def _evaluate_directives(self, control: Optional[clingo.Control]) -> List[Fault]:
        """Give windows, the first step and the constants in patterns their values; return what has none."""
        faults: List[Fault] = []
        self.values = constant_values(self.parts, self.constants, control)
        self.windows = sorted({one.number(self.values, faults) for one in self._directives.windows} | {1})
        first = [one.number(self.values, faults) for one in self._directives.first_steps]
        self.first_step = min([1, *first[-1:]])
        self.forgets = self._directives.forgets
        for one in self.forgets:
            one.number(self.values, faults)
        return faults

    def forgotten_at(self, step: int) -> List[int]:
        """Return the steps whose externals the program's ``#forget t : term.`` directives close at ``step``."""
        return [one.number(self.values, [], step) for one in self.forgets]

    def _check(self) -> List[Fault]:
        """Return all faults that show before anything is grounded, or in the first steps; note what is odd."""
        messages = Messages()
        faults = checks.wrong_arities(self.parts)
        control: Optional[clingo.Control] = None
        try:
            control = self._control(messages)
        except ProgramError as error:
            faults += error.faults
        faults += self._evaluate_directives(control)
        odd = checks.missing_parts(self.parts)
        odd += checks.late_externals(self.parts, self.open_signatures, self.head_signatures, self.values)
        if checks.uses_keywords(self.parts):
            faults += [one for one in odd if "volatile part" not in one.message]
            odd = [one for one in odd if one not in faults]
        self.survey = Survey(self.parts, self.values, self._directives.opened)
        self.remarks += [*odd, *undefined(self.survey), *messages.new_remarks(self.parameter_at)]
        self.remarks += given_values(self.survey, self.constants)
        if not faults and control is not None and suspicious_heads(self.parts, self.values):
            faults += self._try(control, messages)
        return faults

    def redefinition_of(self, atom: str) -> List[Fault]:
        """Return a fault for each rule that may have defined ``atom``, so far defined by another step's, once more."""
        suspects = suspicious_heads(self.parts, self.values)
        try:
            named = {signature_of(parse_atom(atom))}
        except ProgressionError:  # clingo has no name for it
            named = suspects
        found = redefined_by(self.parts, atom or "an atom", named)
        return found or [Fault("<program>", 0, 0, f"redefinition: {atom} is defined twice", kind="redefinition")]

    def said_of_steps(self) -> List[Fault]:
        """Return what clingo says of the first steps, which are ground for it unless they have been."""
        if self._said is None and not self.faults:
            messages = Messages()
            self._try(self._control(messages), messages)
        return self._said or []

    def _try(self, control: clingo.Control, messages: Messages) -> List[Fault]:
        """Ground the first steps; return the faults that show, and note what clingo says of them."""
        self._said = []
        try:
            self.trial = Trial(control, self.first_step)
            faults = self.trial.redefinitions(self.parts)
        except RuntimeError as error:
            return messages.faults(error, self.parameter_at)
        self._said = [one for one in messages.new_remarks(self.parameter_at) if one not in self.remarks]
        return faults
