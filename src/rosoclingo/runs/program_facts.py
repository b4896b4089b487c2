"""Facts in the texts of a run's program, such as sentences and drawings, read without a solver."""

from typing import AbstractSet, List

from clingo import Symbol
from clingo.ast import ASTType

from rosoclingo.oclingo import ProgramError
from rosoclingo.oclingo.program.directives import Directives
from rosoclingo.oclingo.program.sources import Source, read_sources
from rosoclingo.runs.recorded_run import RunProgram
from rosoclingo.runs.topic_atoms import atom_in


def facts_of(program: RunProgram, names: AbstractSet[str]) -> List[Symbol]:
    """Return the ground facts with these names, in order, as written; none if a text cannot be parsed."""
    sources = [Source(one.name, one.text) for one in program.files if any(name in one.text for name in names)]
    try:
        parsed = read_sources(sources, Directives(), [], whole=True)
    except ProgramError:
        return []
    statements = [one for text in parsed for one in text.statements if one.ast_type == ASTType.Rule and not one.body]
    heads = (str(one.head) for one in statements)
    found = [atom_in(text) for text in heads if text.partition("(")[0] in names]
    return [atom for atom in found if atom is not None]
