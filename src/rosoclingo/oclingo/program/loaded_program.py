"""Loaded reactive logic programs: texts, parts, constants, and the statements and options for clingo."""

import json
from functools import cached_property, partial
from hashlib import sha256
from typing import Dict, List, Mapping, Sequence, Tuple

import clingo
from clingo.ast import ASTType, ProgramBuilder

from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program.action_rules import closing_text
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.constants import constant_values
from rosoclingo.oclingo.program.directives import Directives
from rosoclingo.oclingo.program.parts import GUARD, Part, open_part, rewrite
from rosoclingo.oclingo.program.sources import Source, parse_constants, read_sources, statement_at
from rosoclingo.oclingo.progression.terms import signature_of


class LoadedProgram:
    """A reactive logic program in clingo's form, with the values of its directives.

    Attributes:
        sources: the texts from which it was loaded.
        texts: these texts and all included ones, in order.
        parts: its statements, in order.
        constants: values that users set for ``#const`` names, as symbols.
        values: the values of all constants.
        first_step: the first grounded step: 1, or less by ``#iinit``.
        windows: the distinct lengths w of ``#volatile t : w.``, in steps.
        forgets: the ``#forget t : term.`` directives.
        open_signatures: the predicates of ``#external p/n.``
        remarks: warnings; the program can be used in spite of them.

    """

    def __init__(self, sources: Sequence[Source], constants: Mapping[str, str], whole: bool) -> None:
        """Load the texts in order; ``whole`` means that they contain all included files.

        Raises ProgramError with all faults that prevent loading.
        """
        self.sources = tuple(sources)
        self.constants: Dict[str, clingo.Symbol] = parse_constants(constants)
        self.remarks: List[Fault] = []
        self._directives = Directives()
        parsed = read_sources(sources, self._directives, self.remarks, whole)
        self.texts = tuple(one.source for one in parsed)
        self.open_signatures = {one.signature for one in self._directives.opened}
        self.parts: List[Part] = rewrite(parsed, self._directives)
        closing = closing_text(self.parts, self.open_signatures)
        self.parts += rewrite(read_sources([closing], Directives(), []), Directives())
        self.adapt_parts()
        self._load_faults: List[Fault] = []
        messages, control = Messages(), None
        try:
            control = self._control(messages)
            self.remarks += messages.new_remarks(self.parameter_at)
        except ProgramError as error:
            self._load_faults += error.faults
        self.values = constant_values(self.parts, self.constants, control)
        for part in self.parts:
            part.constants.update(self.values)
        windows, first = self._directives.windows, self._directives.first_steps
        self.windows = sorted({one.number(self.values, self._load_faults) for one in windows} | {1})
        self.first_step = min([1, *[one.number(self.values, self._load_faults) for one in first][-1:]])
        self.forgets = self._directives.forgets
        for one in self.forgets:
            one.number(self.values, self._load_faults)

    def adapt_parts(self) -> None:
        """Modify the parts after parsing; a hook for subclasses, which does nothing here."""

    @cached_property
    def advises(self) -> bool:
        """Whether the program has ``#heuristic`` statements."""
        return any(one.ast_type == ASTType.Heuristic for part in self.parts for one in part.statements)

    @property
    def warnings(self) -> List[str]:
        """The remarks as texts."""
        return [str(one) for one in self.remarks]

    @property
    def fingerprint(self) -> str:
        """A hexadecimal SHA-256 of texts and constants, independent of file names."""
        constants = sorted((name, str(value)) for name, value in self.constants.items())
        return sha256(json.dumps([[one.text for one in self.texts], constants]).encode("ascii")).hexdigest()

    def load_into(self, control: clingo.Control) -> None:
        """Add all statements to ``control``; raise RuntimeError like clingo, whose logger receives the details."""
        with ProgramBuilder(control) as builder:
            for part in self.parts:
                builder.add(part.header.ast)
                for statement in part.statements:
                    builder.add(statement.ast)
        for signature in sorted(self.open_signatures):
            for fact in (False, True):
                control.add(*open_part(signature, fact))

    def open_part(self, atom: clingo.Symbol, fact: bool) -> Tuple[str, List[clingo.Symbol]]:
        """Return the program part that makes ``atom`` an external or a fact, with its arguments."""
        return open_part(signature_of(atom), fact)[0], atom.arguments

    def guard(self, window: int, step: int) -> clingo.Symbol:
        """Return the guard of the volatile instance of ``step`` with length ``window``."""
        return clingo.Function(GUARD, [clingo.Number(window), clingo.Number(step)])

    def arguments(self) -> List[str]:
        """Return clingo's command line arguments for every control that loads the program.

        They set the constants and enable ``#heuristic`` statements. Undecided atoms are first tried as false, so that
        plans contain no useless actions. Equivalence preprocessing is off: with several solve calls on one control,
        clasp 3.3.10 to 3.4.0 (clingo 5.7.0 to 5.8.3) loses facts and answers.
        """
        heuristic = ["--heuristic=Domain"] if self.advises else []
        constants = (f"-c{name}={value}" for name, value in self.constants.items())
        return ["-Wno-atom-undefined", "--sign-def=neg", "--eq=0", *heuristic, *constants]

    def is_open_signature(self, atom: clingo.Symbol) -> bool:
        """Return whether an ``#external p/n.`` opens the predicate of ``atom``."""
        return signature_of(atom) in self.open_signatures

    def parameter_at(self, file: str, line: int) -> str:
        """Return the step parameter of the part that contains a line, ``t`` if there is none."""
        for part in self.parts:
            for statement in part.statements if part.parameter else ():
                begin, end = statement.location.begin, statement.location.end
                if begin.filename == file and begin.line <= line <= end.line:
                    return part.parameter
        return "t"

    def _control(self, messages: Messages) -> clingo.Control:
        """Return a control with the program loaded; raise :class:`ProgramError` if clingo rejects it."""
        control = clingo.Control(self.arguments(), logger=messages.log)
        try:
            self.load_into(control)
            control.ground([("__oclingo_no_part", [])])  # makes clingo check for unsafe variables
        except RuntimeError as error:
            as_written = partial(statement_at, self.texts)
            raise ProgramError(messages.faults(error, self.parameter_at, as_written)) from None
        return control
