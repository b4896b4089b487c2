"""What steps see of one another: whether they may be ground together, and what they could use of open signatures.

``#external p/n.`` has no domain: an atom that somebody tells, and that steps which are ground could have seen, means to
ground them anew. But rules such as ``go(D,t) :- moved(D,t), direction(D).`` say which atoms they have any use
for: these may be declared with the step, so that nothing is ground anew for one of them.
"""

from math import prod
from typing import Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, Sign

from rosoclingo.oclingo.program.look_back import time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.patterns import Pattern
from rosoclingo.oclingo.program.signatures import atom_terms, term_signature
from rosoclingo.oclingo.progression.terms import Signature

Constants = Mapping[str, clingo.Symbol]

_STEP = "t__"


def may_see_later(seen: Mapping[Signature, Iterable[Pattern]], defined: Mapping[Signature, Iterable[Pattern]]) -> bool:
    """Tell whether a rule of some step could see what a later step defines or declares; never wrongly False.

    Where none does, it is all the same whether steps are ground one by one or together.
    """
    for signature, patterns in defined.items():
        for one in patterns:
            if one.parameter and any(other.parameter and _is_ahead(other, one) for other in seen.get(signature, ())):
                return True
    return False


def _is_ahead(seen: Pattern, defined: Pattern) -> bool:
    common = seen.offsets.keys() & defined.offsets.keys()
    return all(seen.offsets[position] > defined.offsets[position] for position in common)


class Domain(NamedTuple):
    """The atoms of an open signature that the rules of a step could use.

    Attributes:
        part: the program part, its argument the step, that declares them.
        parameters: the part's parameters.
        text: the part's statements.
        bounds: for each of the statements the predicates of base that bind its variables.

    """

    part: str
    parameters: List[str]
    text: str
    bounds: Tuple[Tuple[Signature, ...], ...]

    def size(self, control: clingo.Control) -> int:
        """Return how many atoms it has at each step at most, by what is ground of base in ``control``."""
        atoms = control.symbolic_atoms
        counts = {one: sum(1 for _ in atoms.by_signature(*one)) for bound in self.bounds for one in bound}
        return sum(prod(counts[one] for one in bound) for bound in self.bounds)


def domains(parts: Sequence[Part], opened: Iterable[Signature], constants: Constants) -> Dict[Signature, Domain]:
    """Return the domains of those ``opened`` predicates whose every atom in a rule has the rule's step in one place.

    The steps at which rules see an atom then follow from it: it is declared with the first of them.
    """
    found: Dict[Signature, Domain] = {}
    fixed = fixed_signatures(parts) - set(opened)
    for signature in sorted(opened):
        uses = list(_uses(parts, signature))
        place = _place(uses, constants)
        if place is None:
            continue
        lines = dict(one for part, statement, term in uses for one in _declaration(part, statement, term, place, fixed))
        name = f"__oclingo_domain_{signature.name}_{signature.arity}"
        if lines:
            found[signature] = Domain(name, [_STEP], "\n".join(lines), tuple(lines.values()))
    return found


def fixed_signatures(parts: Sequence[Part]) -> Set[Signature]:
    """Return the predicates that base alone defines."""
    used = {one.signature for part in parts if part.parameter for _, one in part.atoms if one.head}
    return {one.signature for part in parts for _, one in part.atoms if one.head} - used


_Use = Tuple[Part, Node, Node]


def _uses(parts: Sequence[Part], signature: Signature) -> Iterator[_Use]:
    """Yield all atoms of ``signature``, each with the part and the statement that it stands in."""
    for part in parts:
        for statement, one in part.atoms:
            if one.signature == signature:
                yield part, statement, one.term


def _place(uses: Sequence[_Use], constants: Constants) -> Optional[Tuple[int, int]]:
    """Return the argument that is the step plus a number in all ``uses``, and the greatest of these numbers."""
    offsets: Optional[Dict[int, int]] = None
    for part, _, term in uses:
        if not part.parameter or term.ast_type != ASTType.Function:
            return None
        found = {n: time_offset(one, part.parameter, dict(constants)) for n, one in enumerate(term.arguments)}
        known = {position: offset for position, offset in found.items() if offset is not None}
        offsets = known if offsets is None else {n: max(offsets[n], known[n]) for n in offsets.keys() & known.keys()}
    return max(offsets.items()) if offsets else None


def _declaration(
    part: Part, statement: Node, term: Node, place: Tuple[int, int], fixed: Set[Signature]
) -> Iterator[Tuple[str, Tuple[Signature, ...]]]:
    """Yield, where base binds the variables of ``term``, the statement that declares it, and what binds them."""
    position, offset = place
    others = [one for number, one in enumerate(term.arguments) if number != position]
    binding = [literal for literal in plain_literals(statement) if binds(literal, part.parameter, fixed)]
    bound = {name for literal in binding for name in names_in(literal)}
    names = {name for one in others for name in names_in(one)}
    if not names <= bound or any(mentions(one, part.parameter) for one in others):
        return
    needed = [literal for literal in binding if names & set(names_in(literal))]
    arguments = [*map(str, others)]
    arguments.insert(position, f"{_STEP}+({offset})")
    domain = f" : {', '.join(map(str, needed))}" if needed else ""
    text = f"#external {term.name}({','.join(arguments)}){domain}."
    yield text, tuple(term_signature(literal.atom.symbol) for literal in needed)


def plain_literals(statement: Node) -> Iterator[Node]:
    """Yield the positive literals of a body that are one atom each."""
    for literal in statement.body if hasattr(statement, "body") else ():
        plain = literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign
        if plain and literal.atom.ast_type == ASTType.SymbolicAtom and len(list(atom_terms(literal.atom.symbol))) == 1:
            yield literal


def binds(literal: Node, parameter: str, fixed: Set[Signature]) -> bool:
    """Tell whether the literal binds variables that stand alone in it to what base alone defines."""
    term = literal.atom.symbol
    alone = term.ast_type == ASTType.Function and all(_is_simple(one) for one in term.arguments)
    return alone and term_signature(term) in fixed and not mentions(term, parameter)


def _is_simple(term: Node) -> bool:
    return term.ast_type in (ASTType.Variable, ASTType.SymbolicTerm)


def names_in(term: Node) -> List[str]:
    """Return the names of the variables in a term or literal, each as often as it stands there."""
    return [one.name for one in term.nodes if one.ast_type == ASTType.Variable]


def mentions(term: Node, name: str) -> bool:
    """Tell whether a constant, such as the step, stands in a term, literal or statement."""
    return any(one.ast_type == ASTType.SymbolicTerm and str(one) == name for one in term.nodes)
