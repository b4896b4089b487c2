"""Facts that a program takes no heed of, in its own words: ``_refuse(Fact,Text,C)``."""

from functools import lru_cache
from typing import Dict, FrozenSet, Iterable, Iterator, Tuple

from clingo import Symbol

from rosoclingo.reasoning.explanations import text_of
from rosoclingo.reasoning.keywords import REFUSE, is_keyword
from rosoclingo.reasoning.observations import Observation


def refusals(answer: FrozenSet[Symbol], facts: Iterable[Observation]) -> Iterator[Tuple[str, str]]:
    """Yield why no heed is taken of some of the ``facts`` of an update, and who told them, given its answer."""
    texts = _read(answer)
    for fact in facts if texts else ():
        if fact.atom in texts:
            yield (
                f"'{fact.sent}' from '{fact.origin}' is ignored: {text_of(texts[fact.atom])}",
                fact.origin,
            )


@lru_cache(maxsize=2)  # the same answer comes again and again while things go as planned
def _read(answer: FrozenSet[Symbol]) -> Dict[Symbol, Symbol]:
    """The texts of what is refused."""
    refused = (atom.arguments for atom in answer if is_keyword(atom, REFUSE) and len(atom.arguments) == 3)
    return {fact: text for fact, text, _ in refused}
