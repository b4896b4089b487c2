"""Translation of the control programs of several files that can call each other's procedures."""

import re
from itertools import chain
from pathlib import PurePath
from typing import Dict, List, Sequence, Set

from rosoclingo.golog.grammar import ControlProgram, Declaration, Procedures, Signature, parse, signature
from rosoclingo.golog.recursion import endless_calls
from rosoclingo.golog.writing import Writer, arguments
from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.program.languages import Document, Include, Translation
from rosoclingo.oclingo.reachable import reachable

_NAME = re.compile(r"_*[a-z][A-Za-z0-9_]*\Z")


def read(text: str, name: str) -> Document:
    """Parse a file of control programs; errors are part of the result."""
    program = parse(text, name)
    includes = tuple(Include(one.text[1:-1], one.line, one.tokens[0].column or 1) for one in program.includes)
    return Document(name, includes, program)


def translate(text: str, name: str) -> Translation:
    """Translate a single control program without its includes; ``name`` is the name of its file.

    Raises ProgramError with all faults.
    """
    document = read(text, name)
    return translate_files([document], [[() for _ in document.includes]])[0]


def translate_files(documents: Sequence[Document], included: Sequence[Sequence[Sequence[int]]]) -> List[Translation]:
    """Translate files of control programs into reactive logic programs.

    ``included[i][j]`` lists the indices of the files that the j-th include of file i adds. Raises ProgramError with all
    faults of all files.
    """
    linker = _Linker(documents, included)
    stems = _stems([one.name for one in documents])
    faults: List[Fault] = []
    found: List[Translation] = []
    for number, one in enumerate(documents):
        procedures, own = linker.procedures(number), [*one.content.faults, *linker.faults[number]]
        for call, message, remedy in endless_calls(procedures, number):
            own.append(Fault(one.name, call.line, call.column, message, remedy))
        writer = Writer(one.name, stems[number], one.content, procedures, own)
        faults += sorted(own, key=lambda fault: (fault.line, fault.column))
        found.append(Translation("".join(f"{line}\n" for line in writer.lines), tuple(writer.places)))
    if faults:
        raise ProgramError(faults)
    return found


def _stems(names: Sequence[str]) -> List[str]:
    """Return a unique term for each file, derived from its name."""
    found: List[str] = []
    for name in names:
        stem = PurePath(name).stem
        term = stem if _NAME.match(stem) else '"{}"'.format(re.sub(r'["\\\n]', "_", stem))
        found.append(f"({term},{len(found)})" if term in found else term)
    return found


class _Linker:
    """Resolves includes and collects the procedures of all files; ``faults`` lists the errors of each file."""

    def __init__(self, documents: Sequence[Document], included: Sequence[Sequence[Sequence[int]]]) -> None:
        self._documents, self._included = documents, included
        self._declared: Dict[Signature, Declaration] = {}
        self._include_chain: List[int] = []  # the chain of includes that leads to the present file
        self._linked: Set[int] = set()
        self.faults: List[List[Fault]] = [[] for _ in documents]
        for number in range(len(documents)):
            self._link(number)

    def procedures(self, number: int) -> Procedures:
        """Return the procedures that a file can call: its own, and those of all included files."""
        known = reachable([number], lambda file: chain(*self._included[file]))
        return {one: declared for one, declared in self._declared.items() if declared.number in known}

    def _link(self, number: int) -> None:
        if number in self._linked:
            return
        self._linked.add(number)
        self._include_chain.append(number)
        program: ControlProgram = self._documents[number].content
        for include, way in zip(self._documents[number].includes, self._included[number]):
            for one in way:
                if one in self._include_chain:
                    self._report_cycle(number, include, one)
                self._link(one)
        self._include_chain.pop()
        for procedure in program.procedures:
            self._declare(number, procedure)

    def _report_cycle(self, number: int, include: Include, first: int) -> None:
        names = [
            PurePath(self._documents[one].name).name for one in self._include_chain[self._include_chain.index(first) :]
        ]
        message = "this file includes itself" + (f": {', '.join([*names, names[0]])}" if names[1:] else "")
        remedy = "move shared procedures into a third file" if names[1:] else "remove the include"
        self.faults[number].append(Fault(self._documents[number].name, include.line, include.column, message, remedy))

    def _declare(self, number: int, procedure: SyntaxNode) -> None:
        head, name, file = signature(procedure), procedure.tokens[0], self._documents[number].name
        other = self._declared.setdefault(head, Declaration(number, file, procedure))
        if other.procedure is not procedure:
            where = "" if other.number == number else f"{other.file}, "
            line = other.procedure.line
            message = f"procedure {name} with {arguments(head[1])} is already defined in {where}line {line}"
            self.faults[number].append(Fault(file, name.line or 1, name.column or 1, message, "rename one of them"))
