"""YAML files with the places of their keys, which faults refer to."""

import re
from pathlib import Path
from typing import Any, Callable, Dict, Generic, List, Optional, Set, Tuple, TypeVar

import yaml

from rosoclingo.checking.lint.actions import PlacedName
from rosoclingo.common.reading import Reader
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.sources import Source

T = TypeVar("T")

_UNKNOWN = re.compile(r"unknown key '([^']*)'")
_STRING = "tag:yaml.org,2002:str"


class YamlFile(Generic[T]):
    """A YAML file, or no file.

    Attributes:
        given: whether there is a file.
        name: its name.
        text: its text.
        data: its plain value; None if it is not given, or not valid YAML.
        value: the value that the reader returned; None in the same cases.
        faults: the faults of its entries, or the syntax error.
        doubles: the faults of keys that occur twice.

    """

    def __init__(self, name: Optional[str], read: Callable[[Reader], T]) -> None:
        """Read a file, if there is one, by ``read``; raises ProgramError if it is unreadable."""
        self.given = bool(name)
        source = Source.from_file(Path(name)) if name else Source("", "")
        self.name, self.text = source.name, source.text
        self.data: Any = None
        self.value: Optional[T] = None
        self.faults: List[Fault] = []
        self.doubles: List[Fault] = []
        self._places: Dict[str, Tuple[int, int]] = {}
        self._seen: Set[int] = set()  # visits a node once, even if it has aliases
        if not self.given:
            return
        try:
            self.data = yaml.safe_load(self.text)
            node = yaml.compose(self.text, Loader=yaml.SafeLoader)
        except (yaml.YAMLError, ValueError, RecursionError) as error:
            mark: Optional[Any] = getattr(error, "problem_mark", None)
            place = (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)
            problem = getattr(error, "problem", None) or str(error).splitlines()[0]
            self.faults.append(Fault(self.name, *place, f"invalid YAML: {problem}", kind="configuration"))
            return
        self._note("", node)
        reader = Reader(self.data)
        self.value = read(reader)
        self.faults += [self.fault(text, "configuration") for text in reader.faults]

    def fault(self, text: str, kind: str) -> Fault:
        """Return the fault of a reader, with the place of the keys that its text begins with."""
        begins = (path for path in self._places if text.startswith(path) and text[len(path) :][:1] in ("", *":. ["))
        path, unknown = max(begins, key=len, default=""), _UNKNOWN.search(text)
        if unknown is not None:
            inside = f"{path}.{unknown.group(1)}" if path else unknown.group(1)
            path = inside if inside in self._places else path
        return Fault(self.name, *self._places.get(path, (1, 1)), text, "", kind)

    def named(self, key: str, name: str) -> PlacedName:
        """Return a name with the place of a key of the outermost mapping."""
        return PlacedName(name, self.name, *self._places.get(key, (1, 1)))

    def _note(self, path: str, node: Any) -> None:
        """Record the places of the keys below a node, and the keys that occur twice."""
        if id(node) in self._seen:
            return
        self._seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            lines: Dict[str, int] = {}
            for key, value in node.value:
                name, mark = _text(key), key.start_mark
                inside, place = f"{path}.{name}" if path else name, (mark.line + 1, mark.column + 1)
                self._places[inside] = place  # of two equal keys the last takes effect
                if name in lines and name != "<<":
                    text = f"the key {name} is already in line {lines[name]}; the last entry takes effect"
                    self.doubles.append(Fault(self.name, *place, text, "remove one of them", "configuration"))
                lines[name] = place[0]
                self._note(inside, value)
        elif isinstance(node, yaml.SequenceNode):
            for index, value in enumerate(node.value):
                inside = f"{path}[{index}]"
                self._places.setdefault(inside, (value.start_mark.line + 1, value.start_mark.column + 1))
                self._note(inside, value)


def _text(key: Any) -> str:
    """Return the text of a key's value in the data, such as ``True`` for ``yes``."""
    plain = isinstance(key, yaml.ScalarNode) and key.tag != _STRING and not key.tag.endswith(":merge")
    try:
        return str(yaml.safe_load(key.value)) if plain else str(key.value)
    except yaml.YAMLError:
        return str(key.value)
