"""YAML files whose faults have lines: the readers know keys, here is where each of them stands."""

import re
from pathlib import Path
from typing import Any, Dict, List, Optional, Set, Tuple

import yaml

from rosoclingo.checking.lint.actions import Named
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.sources import Source

_UNKNOWN = re.compile(r"unknown key '([^']*)'")

_DEEPEST = 32  # levels of which the places are known
_STRING = "tag:yaml.org,2002:str"


class YamlFile:
    """A YAML file.

    Attributes:
        name: its name.
        text: its text.
        data: what it holds, None where it is no YAML.
        faults: that it is none.
        doubles: keys that stand in it twice.

    """

    def __init__(self, name: str) -> None:
        """Read a file; raises ProgramError where that is not possible."""
        source = Source.from_file(Path(name))
        self.name, self.text = source.name, source.text
        self.data: Any = None
        self.faults: List[Fault] = []
        self.doubles: List[Fault] = []
        self._places: Dict[str, Tuple[int, int]] = {}
        self._seen: Set[int] = set()  # nodes, which are looked at once however many aliases they have
        try:
            self.data = yaml.safe_load(self.text)
            node = yaml.compose(self.text, Loader=yaml.SafeLoader)
        except (yaml.YAMLError, ValueError, RecursionError) as error:
            self.faults.append(self._no_yaml(error))
        else:
            self._note("", node, 0)

    def fault(self, text: str, kind: str) -> Fault:
        """Return a fault that a reader found, whose text begins with the keys that lead to it."""
        path = self._longest(text)
        unknown = _UNKNOWN.search(text)
        if unknown is not None:
            inside = f"{path}.{unknown.group(1)}" if path else unknown.group(1)
            path = inside if inside in self._places else path
        return Fault(self.name, *self._places.get(path, (1, 1)), text, "", kind)

    def named(self, key: str) -> Named:
        """Return a key of the outermost mapping with its place."""
        return Named(key, self.name, *self._places.get(key, (1, 1)))

    def _longest(self, text: str) -> str:
        """Return the longest of the known places with which ``text`` begins."""
        begins = [path for path in self._places if text.startswith(path) and text[len(path) :][:1] in ("", *":. [")]
        return max(begins, key=len, default="")

    def _no_yaml(self, error: Exception) -> Fault:
        mark: Optional[Any] = getattr(error, "problem_mark", None)
        place = (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        return Fault(self.name, *place, f"no YAML: {problem}", kind="configuration")

    def _note(self, path: str, node: Any, depth: int) -> None:
        """Note where the keys below a node stand, and which stand there twice."""
        if id(node) in self._seen or depth >= _DEEPEST:
            return
        self._seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            told: Dict[str, int] = {}
            for key, value in node.value:
                name, mark = _text(key), key.start_mark
                inside, place = f"{path}.{name}" if path else name, (mark.line + 1, mark.column + 1)
                self._places[inside] = place  # of keys that stand there twice the last counts
                if name in told and name != "<<":
                    text = f"the key {name} stands in line {told[name]} already: of the two the last one counts"
                    self.doubles.append(Fault(self.name, *place, text, "leave one of them out", "configuration"))
                told[name] = place[0]
                self._note(inside, value, depth + 1)
        elif isinstance(node, yaml.SequenceNode):
            for index, value in enumerate(node.value):
                inside = f"{path}[{index}]"
                self._places.setdefault(inside, (value.start_mark.line + 1, value.start_mark.column + 1))
                self._note(inside, value, depth + 1)


def _text(key: Any) -> str:
    """Return a key as the data has it: True for yes, 1 for 1."""
    plain = isinstance(key, yaml.ScalarNode) and key.tag != _STRING and not key.tag.endswith(":merge")
    try:
        return str(yaml.safe_load(key.value)) if plain else str(key.value)
    except yaml.YAMLError:
        return str(key.value)
