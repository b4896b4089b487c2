"""Program parts, and guards that limit volatile statements to their window."""

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import Dict, Iterator, List, Sequence, Set, Tuple

import clingo
from clingo.ast import AST, ASTType, Id, Literal, Program, Sign, Transformer

from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program.directives import VOLATILE_PREFIX, Directives
from rosoclingo.oclingo.program.nodes import Node, fault_at, make, parse
from rosoclingo.oclingo.program.patterns import Pattern
from rosoclingo.oclingo.program.signatures import Atom, atoms_in, term_signature
from rosoclingo.oclingo.program.sources import LoadedFile
from rosoclingo.oclingo.progression.terms import Signature

PARTS = ("base", "cumulative", "volatile")
_OTHER_SYSTEMS = {  # parts of clingo's incmode and of telingo, with their equivalents
    "step": "clingo's incmode calls it step; write #program cumulative(t).",
    "check": "clingo's incmode calls it check; write #program volatile(t). for a plan's last step, without query(t)",
    "initial": "telingo's part; write #program base. with 0 for the step, as in at(home,0)",
    "dynamic": "telingo's part; write #program cumulative(t). with t for the step, t-1 for the one before ('p)",
    "always": "telingo's part; write its rules into #program cumulative(t)., and those of step 0 into base",
    "final": "telingo's part; write #program volatile(t). with t for the step",
}
GUARD = "__oclingo_volatile"
"""``__oclingo_volatile(W,T)``: true while the instance of ``#volatile t : W.`` for step T holds."""

_GUARDED = (ASTType.Rule, ASTType.Minimize, ASTType.ShowTerm, ASTType.Edge, ASTType.Heuristic, ASTType.ProjectAtom)


class Occurrence(Pattern):
    """An atom in a statement of a program.

    Attributes:
        part: the part of the statement.
        signature: the atom's predicate.
        head: whether the atom is a head.
        positive: whether it is a positive body atom.

    """

    def __init__(self, part: "Part", statement: Node, atom: Atom) -> None:
        term, self.head, self.positive = atom
        super().__init__(term, part.parameter, statement, part.constants)
        self.part, self.signature = part, term_signature(term)

    @property
    def declares(self) -> bool:
        """Whether an ``#external`` declares the atom."""
        return self.head and self.statement.ast_type == ASTType.External

    @property
    def defines(self) -> bool:
        """Whether a rule has the atom in its head."""
        return self.head and self.statement.ast_type == ASTType.Rule

    def fault(self, kind: str, message: str, remedy: str) -> Fault:
        """Return a fault at the atom."""
        return fault_at(self.term, kind, message, remedy)


@dataclass
class Part:
    """Consecutive statements of one program part.

    Attributes:
        name: base, cumulative or volatile.
        parameter: name of the step parameter, empty in base.
        header: the ``#program`` statement.
        statements: the statements; in volatile parts guarded, after the declaration of the guard.
        window: the length of the window of a volatile part, as written.
        constants: the values of the program's constants, once they are known.

    """

    name: str
    parameter: str
    header: Node
    statements: List[Node] = field(default_factory=list)
    window: str = ""
    constants: Dict[str, clingo.Symbol] = field(default_factory=dict)

    @cached_property
    def found(self) -> List[Tuple[Node, List[Occurrence]]]:
        """Each statement with its atoms; cached, so read it only after the last statement was added."""
        return [(one, [Occurrence(self, one, atom) for atom in atoms_in(one)]) for one in self.statements]

    @property
    def atoms(self) -> Iterator[Occurrence]:
        """All atoms of the statements."""
        return (one for _, found in self.found for one in found)


def rewrite(parsed: Sequence[LoadedFile], directives: Directives) -> List[Part]:
    """Return the parts of the parsed sources in order; raise :class:`ProgramError` for unknown parts."""
    parts: List[Part] = []
    faults: List[Fault] = []
    for source in parsed:
        for statement in source.statements:
            if statement.ast_type == ASTType.Program:
                parts.append(_open_part(statement, directives, faults))
            else:
                _add(parts[-1], statement)
    if faults:
        raise ProgramError(faults)
    return parts


def _open_part(header: Node, directives: Directives, faults: List[Fault]) -> Part:
    name, parameters = header.name, [parameter.name for parameter in header.parameters]
    window = ""
    if name.startswith(VOLATILE_PREFIX):
        window, name = directives.windows[int(name[len(VOLATILE_PREFIX) :])].value, "volatile"
    elif name == "volatile":
        window = "1"
    if name not in PARTS or len(parameters) != (0 if name == "base" else 1):
        text = "{}({})".format(name, ",".join(parameters)) if parameters else name
        remedy = _OTHER_SYSTEMS.get(name, "a reactive program has the parts base, cumulative(t) and volatile(t)")
        faults.append(fault_at(header, "unknown-part", f"unknown program part {text}", remedy))
        window = ""  # a guard needs the parameter
    parameter = parameters[0] if parameters else ""
    # for clingo, volatile parts of all windows have the same name; their parameters can have different names
    renamed = make(Program, header.location, name, [Id(header.location, parameter)] if parameter else [])
    part = Part(name, parameter, renamed, window=window)
    if window:
        part.statements.append(parse(f"#external {GUARD}(({window}),{parameter}).")[-1])
    return part


_ANONYMOUS = re.compile(r"(?<!\w)_(?!\w)")


class _Namer(Transformer):
    """Names the anonymous variables of positive literals, which does not change the meaning.

    clingo projects a ``_`` by an auxiliary rule, which it would reground for all steps at each step.
    """

    def __init__(self) -> None:
        self._count = 0

    def visit_Literal(self, node: AST) -> AST:
        """Visit only positive literals: under ``not`` the projection matters."""
        return node if node.sign != Sign.NoSign else node.update(**self.visit_children(node))

    def visit_Variable(self, node: AST) -> AST:
        """Replace ``_`` by a unique name."""
        if node.name != "_":
            return node
        self._count += 1
        return node.update(name=f"Any__{self._count}")


def _add(part: Part, statement: Node) -> None:
    if part.name != "base" and _ANONYMOUS.search(str(statement)):  # cheaper than a visit
        statement = Node(_Namer().visit(statement.ast))
    if part.window and statement.ast_type in _GUARDED:
        guard = make(Literal, statement.location, Sign.NoSign, part.statements[0].atom)
        statement = statement.update(body=[*statement.body, guard])
    part.statements.append(statement)


def open_part(signature: Signature, fact: bool) -> Tuple[str, List[str], str]:
    """Return name, parameters and text of a part that makes one atom of ``signature`` an external or a fact.

    The parameters are the atom's arguments. Atoms that are added through clingo's backend do not work: the grounder
    omits some rule instances with them.
    """
    # the sign is included, so that the names for two signatures always differ
    name = f"__oclingo_{'fact' if fact else 'open'}_{int(signature.positive)}_{signature.name}_{signature.arity}"
    parameters = [f"x{number}" for number in range(signature.arity)]
    atom = ("" if signature.positive else "-") + signature.name
    atom += f"({','.join(parameters)})" if parameters else ""
    return name, parameters, f"{atom}." if fact else f"#external {atom}."


def fixed_signatures(parts: Sequence[Part]) -> Set[Signature]:
    """Return the predicates that only base defines."""
    used = {one.signature for part in parts if part.parameter for one in part.atoms if one.head}
    return {one.signature for part in parts for one in part.atoms if one.head} - used
