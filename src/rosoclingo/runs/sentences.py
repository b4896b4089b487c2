"""The program's sentences for actions: ``_says(move_base,"drives to {}").`` among its facts.

The sentence of ``move_base`` is also that of ``move_base(r1)``: "r1 drives to office2".
"""

from typing import Dict, Iterable, List, Mapping, Optional

from clingo import SymbolType

from rosoclingo.reasoning.keywords import Action, name_of
from rosoclingo.runs.program_facts import facts_of
from rosoclingo.runs.recorded_run import RunProgram
from rosoclingo.runs.topic_atoms import action_in

#: ``_says(A,Text)``: a text about action A, with ``{}`` in place of its parameter; a text without ``{}`` omits it.
SAYS = "_says"

_PLACE = "{}"

_CANCELLING = ("recalling", "preempting")


class Sentences:
    """Describes actions: by a text for each interface, or by interface and parameter if it has no text."""

    def __init__(self, texts: Optional[Mapping[str, str]] = None) -> None:
        self._texts: Dict[str, str] = dict(texts or {})

    def of(self, action: Action) -> str:
        """Return the sentence for an action, "drives to office2"."""
        name, actors = action.interface_name, action.interface
        text = self._texts.get(name, f"{name} {_PLACE}")
        if actors.type is SymbolType.Function and actors.name in self._texts and name not in self._texts:
            text = f"{', '.join(map(name_of, actors.arguments))} {self._texts[actors.name]}"
        return text.replace(_PLACE, name_of(action.parameter))

    def now(self, cycle: int, state: str, plan: Iterable[str]) -> str:
        """Return a line about the actions of a cycle in a plan, for a goal with this state (its feedback)."""
        if state.startswith("waiting"):
            return state
        word, _, remark = state.partition(": ")
        doing = ", ".join(map(self.of, actions_now(cycle, plan)))
        said = f"{doing} ({remark})" if doing and remark else doing or remark or "nothing to do now"
        return f"is cancelled: {said}" if word in _CANCELLING else said


def actions_now(cycle: int, plan: Iterable[str]) -> List[Action]:
    """Return the actions of a cycle in a plan's texts."""
    return [one for one in filter(None, map(action_in, plan)) if one.cycle == cycle]


def sentences_of(program: RunProgram) -> Sentences:
    """Return the sentences in a program's texts; invalid texts are ignored."""
    facts = [one for one in facts_of(program, {SAYS}) if one.match(SAYS, 2)]
    return Sentences(
        {
            name_of(action): text.string
            for action, text in (one.arguments for one in facts)
            if text.type is SymbolType.String
        }
    )
