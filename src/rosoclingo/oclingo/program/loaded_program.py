"""Reactive logic programs as they are loaded: texts, parts, constants, and all that clingo has to be given."""

import json
from functools import cached_property, partial
from hashlib import sha256
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

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
        sources: the texts that it was made of.
        texts: these and all that they include, in order.
        parts: its statements, in order.
        constants: values of ``#const`` names that were given from outside, as symbols.
        values: the values of all constants.
        first_step: the first grounded step (1 unless ``#iinit`` says less).
        windows: the distinct lengths w of ``#volatile t : w.``, in steps.
        forgets: the ``#forget t : term.`` directives.
        open_signatures: the predicates of ``#external p/n.``
        remarks: oddities that do not keep the program from being used.

    """

    def __init__(self, sources: Sequence[Source], constants: Mapping[str, str], whole: bool) -> None:
        """Take the texts in order; with ``whole`` all that they include is among them.

        Raises ProgramError with all faults for which the texts cannot be read.
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
        self._messages, self._load_faults = Messages(), []  # type: Messages, List[Fault]
        self._loaded: Optional[clingo.Control] = None
        try:
            self._loaded = self._control(self._messages)
        except ProgramError as error:
            self._load_faults += error.faults
        self.values = constant_values(self.parts, self.constants, self._loaded)
        windows, first = self._directives.windows, self._directives.first_steps
        self.windows = sorted({one.number(self.values, self._load_faults) for one in windows} | {1})
        self.first_step = min([1, *[one.number(self.values, self._load_faults) for one in first][-1:]])
        self.forgets = self._directives.forgets
        for one in self.forgets:
            one.number(self.values, self._load_faults)

    def adapt_parts(self) -> None:
        """Change the parts once they are read; subclasses that need other statements do so here."""

    @cached_property
    def advises(self) -> bool:
        """Whether ``#heuristic`` statements tell the solver where to look first."""
        return any(one.ast_type == ASTType.Heuristic for part in self.parts for one in part.statements)

    @property
    def warnings(self) -> List[str]:
        """The remarks as text."""
        return [str(one) for one in self.remarks]

    @property
    def fingerprint(self) -> str:
        """A SHA-256 of texts and constants in hexadecimal, independent of where the files lie."""
        constants = sorted((name, str(value)) for name, value in self.constants.items())
        return sha256(json.dumps([[one.text for one in self.texts], constants]).encode("ascii")).hexdigest()

    def load_into(self, control: clingo.Control) -> None:
        """Add all statements to ``control``; raise RuntimeError as clingo does, details go to its logger."""
        with ProgramBuilder(control) as builder:
            for part in self.parts:
                builder.add(part.header.ast)
                for statement in part.statements:
                    builder.add(statement.ast)
        for signature in sorted(self.open_signatures):
            for fact in (False, True):
                control.add(*open_part(signature, fact))

    def open_part(self, atom: clingo.Symbol, fact: bool) -> Tuple[str, List[clingo.Symbol]]:
        """Return the part to ground, with its arguments, that makes ``atom`` an external or a fact."""
        return open_part(signature_of(atom), fact).name, atom.arguments

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

    def is_open_signature(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom`` is of a signature that ``#external p/n.`` opens."""
        return signature_of(atom) in self.open_signatures

    def parameter_at(self, file: str, line: int) -> str:
        """Return the step parameter of the part that a line stands in, ``t`` where that is not known."""
        for part in self.parts:
            for statement in part.statements if part.parameter else ():
                begin, end = statement.location.begin, statement.location.end
                if begin.filename == file and begin.line <= line <= end.line:
                    return part.parameter
        return "t"

    def forgotten_at(self, step: int) -> List[int]:
        """Return the steps whose externals the program's ``#forget t : term.`` directives close at ``step``."""
        return [one.number(self.values, [], step) for one in self.forgets]

    def _control(self, messages: Messages) -> clingo.Control:
        """Return a control with the program loaded; raise :class:`ProgramError` where clingo won't take it."""
        control = clingo.Control(self.arguments(), logger=messages.log)
        try:
            self.load_into(control)
            control.ground([("__oclingo_no_part", [])])  # now clingo looks for unsafe variables
        except RuntimeError as error:
            as_written = partial(statement_at, self.texts)
            raise ProgramError(messages.faults(error, self.parameter_at, as_written)) from None
        return control
