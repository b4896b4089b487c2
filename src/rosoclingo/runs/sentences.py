"""The program's sentences for actions, goals and facts: the facts ``_says`` of its base part.

``_says(move_base,"drives to {}").`` is about an action; the sentence of ``move_base`` is also that of
``move_base(r1)``: "r1 drives to office2". ``_says("bring(Room,Thing)","Bring the {Thing} to the {Room}").`` is about
goals, or facts from outside: those that the pattern matches. A label with a title is named by its title.
"""

import re
from typing import Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.oclingo import ProgressionError, parse_term
from rosoclingo.planning.explaining.atom_patterns import ANY, Bound, arguments_in, is_variable, matches, pattern_in
from rosoclingo.reasoning.keywords import ACTION_LIB, REQUEST, RETURN, Action, name_of
from rosoclingo.runs.program_facts import facts_of
from rosoclingo.runs.recorded_run import RunProgram
from rosoclingo.runs.topic_atoms import action_in, atom_in, return_in

#: ``_says(A,Text)``: a text about action A, with ``{}`` in place of its parameter; a text without ``{}`` omits it.
#: ``_says(Pattern,Text)``: a text about goals or facts; the pattern is a string, and ``{Name}`` stands for a variable.
SAYS = "_says"

_PLACE = "{}"
_NAMED = re.compile(r"\{(\w+)\}")
_CALL = re.compile(r"(?<!\w)_*[a-z][\w']*\(")
_EDGE = re.compile(r'[()]|"(?:[^"\\]|\\.)*"')

_CANCELLING = ("recalling", "preempting")


class PatternSentence(NamedTuple):
    """The text of a ``_says`` fact about goals or facts, with their pattern."""

    pattern: Symbol
    text: str

    def of(self, term: Symbol, names: Mapping[str, str]) -> Optional[str]:
        """Return the sentence for a goal or a fact, None for one of another kind; ``names`` replace terms."""
        bound: Bound = {}
        if not matches(self.pattern, term, bound):
            return None
        words = {name: names.get(str(value), name_of(value)) for name, value in bound.items()}
        return _NAMED.sub(lambda found: words.get(found.group(1), found.group()), self.text)


class Sentences:
    """Describes actions, goals and facts; those without a text are described by their terms.

    ``texts`` maps names of interfaces to texts. Of the ``patterns`` that match, the one with most fixed names counts.

    Attributes:
        titles: the titles of labels, which replace their names.

    """

    def __init__(
        self,
        texts: Optional[Mapping[str, str]] = None,
        patterns: Sequence[PatternSentence] = (),
        titles: Optional[Mapping[str, str]] = None,
    ) -> None:
        self._texts: Dict[str, str] = dict(texts or {})
        self._patterns = sorted(patterns, key=lambda one: -_size(one.pattern))
        self.titles: Dict[str, str] = dict(titles or {})
        names = "|".join(map(re.escape, sorted(self.titles, key=len, reverse=True)))
        self._label = re.compile(rf"(?<![\w(,])(?:{names})(?!\w|[()]|,\S)") if names else None
        self._calls = {ACTION_LIB, REQUEST, RETURN, *(one.pattern.name for one in patterns)}

    def of(self, action: Action) -> str:
        """Return the sentence for an action, "drives to office2" or "r1 drives to office2"."""
        actors, text = self._text_of(action)
        return f"{actors}{self._fill(text, action)}"

    def deed(self, action: Action) -> str:
        """Return the sentence for an action without its robots, "drives to office2"."""
        return self._fill(self._text_of(action)[1], action)

    def kind(self, action: Action) -> str:
        """Return the sentence for an action without robots and parameter, "drives to …"."""
        return self._text_of(action)[1].replace(_PLACE, "…")

    def _text_of(self, action: Action) -> Tuple[str, str]:
        """Return the robots of an action, followed by a space if there are some, and its text."""
        name, base = action.interface_name, action.interface
        if name not in self._texts and arguments_in(base) and base.name in self._texts:
            return f"{', '.join(actors_of(action))} ", self._texts[base.name]
        return "", self._texts.get(name, f"{name} {_PLACE}")

    def _fill(self, text: str, action: Action) -> str:
        return text.replace(_PLACE, self.titles.get(str(action.parameter), name_of(action.parameter)))

    def goal(self, request: str) -> str:
        """Return the sentence for a goal, "Bring package 1 from office3 to office2"; other texts are unchanged."""
        try:
            return self._of_term(parse_term(request)) or request
        except ProgressionError:
            return request

    def fact(self, text: str) -> str:
        """Return the sentence for a fact, "the study is closed"; other texts are unchanged."""
        atom = atom_in(text)
        return (atom and self._of_term(atom)) or text

    def _of_term(self, term: Symbol) -> Optional[str]:
        return next(filter(None, (one.of(term, self.titles) for one in self._patterns)), None)

    def reason(self, request: str, message: str) -> str:
        """Return a message about a goal without the goal at its beginning, and with sentences in place of terms."""
        for opening in (request, f"the program rejects {request}: ", f"the program aborts {request}: ", "is aborted: "):
            message = (message[len(opening) :] if message.startswith(opening) else message).strip()
        return self.replace(message)

    def replace(self, message: str) -> str:
        """Return a message with sentences in place of the goals, actions and facts in it, and with titles of labels."""
        found, at = [], 0
        for call in _CALL.finditer(message):
            end = _end_of(message, call.end()) if call.start() >= at and call.group()[:-1] in self._calls else 0
            words = self._of_call(message[call.start() : end]) if end else None
            if words is not None:
                quoted = message[: call.start()].endswith("'")
                found += [self._titled(message[at : call.start()]), words if quoted else f"'{words}'"]
                at = end
        return "".join([*found, self._titled(message[at:])])

    def _titled(self, text: str) -> str:
        """Return a text with titles in place of the labels that stand alone in it, not as an argument of a term."""
        return self._label.sub(lambda found: self.titles[found.group()], text) if self._label else text

    def _of_call(self, text: str) -> Optional[str]:
        """Return the words for a goal, an action, a request or a fact; None for any other text."""
        action, answer, term = action_in(text), return_in(text), atom_in(text)
        if action is not None:
            return self.of(action)
        if answer is not None:
            return f"{answer.interface_name} returned {name_of(answer.value)}"
        if term is not None and term.match(REQUEST, 2):
            term = term.arguments[0]
        return None if term is None else self._of_term(term)

    def now(self, cycle: int, state: str, plan: Iterable[str]) -> str:
        """Return a line about the actions of a cycle in a plan, for a goal with this state (its feedback)."""
        if state.startswith("waiting"):
            return state
        word, _, remark = state.partition(": ")
        actions = (one for one in map(action_in, plan) if one is not None and one.cycle == cycle)
        doing = ", ".join(map(self.of, actions))
        said = f"{doing} ({remark})" if doing and remark else doing or remark or "nothing to do now"
        return f"is cancelled: {said}" if word in _CANCELLING else said


def actors_of(action: Action) -> List[str]:
    """Return the robots of an action, the arguments of its interface: ``r1`` for ``move_base(r1)``."""
    return [name_of(one) for one in arguments_in(action.interface)]


def sentences_of(program: RunProgram) -> Sentences:
    """Return the sentences in a program's texts; invalid texts are ignored."""
    texts, patterns = {}, []
    for what, text in (one.arguments for one in facts_of(program, {SAYS}) if one.match(SAYS, 2)):
        if text.type is SymbolType.String:
            pattern = pattern_in(what.string) if what.type is SymbolType.String else None
            if pattern is not None and arguments_in(pattern):
                patterns.append(PatternSentence(pattern, text.string))
            else:
                texts[name_of(what)] = text.string
    titles = program.settings.get("titles", {})
    found = titles.items() if isinstance(titles, dict) else ()
    return Sentences(texts, patterns, {name: title for name, title in found if isinstance(title, str)})


def _size(pattern: Symbol) -> int:
    """Return the number of functions and constants in a pattern."""
    fixed = not (is_variable(pattern) or pattern == ANY)
    return int(fixed) + sum(map(_size, arguments_in(pattern)))


def _end_of(text: str, start: int) -> int:
    """Return the end of a call whose arguments begin at ``start``, 0 if it does not end."""
    depth = 1
    for edge in _EDGE.finditer(text, start):
        depth += {"(": 1, ")": -1}.get(edge.group(), 0)
        if not depth:
            return edge.end()
    return 0
