"""Order forms of a page: kinds of goals and of facts with their choices, declared in YAML.

doc/web_page.md describes the format. The places of one order differ: a label chosen from ``labels`` cannot be another
place of the order.
"""

import re
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Sequence, Tuple

from rosoclingo.checking.sample_requests import IDENTIFIER, combine
from rosoclingo.common.reading import Reader
from rosoclingo.oclingo import ProgressionError, parse_atom, parse_term
from rosoclingo.reasoning.keywords import RESERVED, RETURN

#: Choices whose options depend on the world.
LABELS, PACKAGES, PLACE_OF = "labels", "packages", "place of "

_NAME = re.compile(r"\{(\w+)\}")

_UNTITLED: Mapping[str, str] = {}


class OrderError(ValueError):
    """An invalid order; the text has the reason."""


class Choice(NamedTuple):
    """The options for a name in an order: ``kind`` is LABELS, PACKAGES, PLACE_OF, or empty for ``terms``."""

    name: str
    kind: str = ""
    terms: Tuple[str, ...] = ()
    of: str = ""


class OrderForm(NamedTuple):
    """A kind of goal, or of fact: ``term`` has ``{name}`` in place of each choice."""

    title: str
    term: str
    choices: Tuple[Choice, ...]
    is_fact: bool = False

    def describe(
        self, labels: Sequence[str], packages: Mapping[str, str], titles: Mapping[str, str] = _UNTITLED
    ) -> Dict[str, Any]:
        """Return the form for a page: its title, and its fields with their options.

        ``packages`` maps each package to its label, empty without one. ``apart`` lists the fields whose choice or place
        has to differ from that of a field. ``titles`` are the names of labels for people.
        """
        fields = []
        for one in self.choices:
            if one.kind != PLACE_OF:
                terms = _options(one, labels, packages)
                options = [[term, _described(term, one, packages, titles)] for term in terms]
                fields.append({"name": one.name, "options": options, **self._apart(one, packages)})
        return {"title": self.title, "fact": self.is_fact, "fields": fields}

    def _apart(self, choice: Choice, packages: Mapping[str, str]) -> Dict[str, Any]:
        """Return the fields that exclude options of a choice of labels."""
        if choice.kind != LABELS:
            return {}
        earlier = self.choices[: self.choices.index(choice)]
        apart: List[Dict[str, Any]] = [
            {"field": one.of, "places": dict(packages)} for one in self.choices if one.kind == PLACE_OF
        ]
        apart += [{"field": one.name, "places": None} for one in earlier if one.kind == LABELS]
        return {"apart": apart} if apart else {}

    def fill(self, chosen: Mapping[str, Any], labels: Sequence[str], packages: Mapping[str, str]) -> str:
        """Return the goal or the fact for the chosen options; raises OrderError for invalid choices."""
        found: Dict[str, str] = {}
        for one in self.choices:
            if one.kind == PLACE_OF:
                continue
            term = chosen.get(one.name)
            if not isinstance(term, str) or term not in _options(one, labels, packages):
                raise OrderError(f"{one.name}: choose one of the options")
            found[one.name] = term
        for one in self.choices:
            if one.kind == PLACE_OF:
                found[one.name] = packages[found[one.of]]
        self._check_places(found)
        return _NAME.sub(lambda match: found[match.group(1)], self.term)

    def words(self, chosen: Mapping[str, Any], titles: Mapping[str, str] = _UNTITLED) -> str:
        """Return the title and the chosen options."""
        terms = (str(chosen[one.name]) for one in self.choices if one.kind != PLACE_OF)
        options = ", ".join(titles.get(term, term) for term in terms)
        return f"{self.title}: {options}" if options else self.title

    def _check_places(self, found: Mapping[str, str]) -> None:
        """Raise OrderError if a chosen label is another place of the same order."""
        places = [one for one in self.choices if one.kind in (LABELS, PLACE_OF)]
        for one in (place for place in places if place.kind == LABELS):
            same = next((other for other in places if other != one and found[other.name] == found[one.name]), None)
            if same is not None:
                raise OrderError(f"{one.name}: {found[one.name]} is already '{same.name}', choose another place")

    def samples(self, labels: Sequence[str], packages: Sequence[str]) -> Iterator[str]:
        """Yield some goals or facts that can be chosen in any world with these labels and packages.

        A package can also be a number, and can be at any of the ``labels``.
        """
        known = {LABELS: labels, PLACE_OF: labels, PACKAGES: [IDENTIFIER, *packages]}
        for words in combine([known.get(one.kind, one.terms) for one in self.choices]):
            found = dict(zip((one.name for one in self.choices), words))
            yield _NAME.sub(lambda match, found=found: found[match.group(1)], self.term)  # type: ignore[misc]


def read_orders(reader: Reader) -> Tuple[OrderForm, ...]:
    """Read the forms; the reader collects the faults."""
    return tuple(_form(one) for one in reader.items("a list of orders", ()))


def _form(reader: Reader) -> OrderForm:
    title, kind = reader.at("title").text(), "fact" if "fact" in (reader.value or ()) else "goal"
    term = reader.at(kind).text()
    choices = tuple(
        _choice(name, value) for name, value in reader.at("choices").entries("a mapping of names to choices")
    )
    reader.close()
    form = OrderForm(title, term, choices, kind == "fact")
    names = {one.name: one for one in choices}
    for name in set(_NAME.findall(term)) ^ set(names):
        reader.fault(f"'{name}' has to be in the {kind}, as {{{name}}}, and among the choices")
    for one in choices:
        if one.kind == PLACE_OF and (one.of not in names or names[one.of].kind != PACKAGES):
            reader.fault(f"'{one.of}' is not a choice of packages")
    if not reader.faults:
        fault = _fault_of(_NAME.sub("1", term), form.is_fact)
        if fault:
            reader.at(kind).fault(fault)
    return form


def _fault_of(term: str, is_fact: bool) -> str:
    """Return why a term cannot be a goal, or a fact of an interface; empty if it can."""
    if not is_fact:
        return "" if _is_term(term) else "is not a ground term"
    try:
        atom = parse_atom(term)
    except ProgressionError:
        return "is not a ground atom"
    signature = (atom.name, len(atom.arguments))
    reserved = signature in RESERVED or signature == (RETURN, 3)
    return "is reserved for the core, the program and the interfaces" if reserved else ""


def _choice(name: str, reader: Reader) -> Choice:
    value = reader.value
    if value in (LABELS, PACKAGES):
        return Choice(name, value)
    if isinstance(value, str) and value.startswith(PLACE_OF):
        return Choice(name, PLACE_OF, of=value[len(PLACE_OF) :].strip())
    terms = tuple(
        str(one.value) for one in reader.items(f"a list of terms, '{LABELS}', '{PACKAGES}' or '{PLACE_OF}NAME'")
    )
    for term in terms:
        if not _is_term(term):
            reader.fault(f"'{term}' is not a ground term")
    return Choice(name, terms=terms)


def _options(choice: Choice, labels: Sequence[str], packages: Mapping[str, str]) -> Sequence[str]:
    if choice.kind == LABELS:
        return labels
    if choice.kind == PACKAGES:
        return [name for name, place in packages.items() if place]
    return choice.terms


def _described(term: str, choice: Choice, packages: Mapping[str, str], titles: Mapping[str, str]) -> str:
    if choice.kind == PACKAGES:
        return f"{term} (at {titles.get(packages[term], packages[term])})"
    return titles.get(term, term)


def _is_term(text: str) -> bool:
    try:
        parse_term(text)
    except ProgressionError:
        return False
    return True
