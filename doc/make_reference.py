"""``./dev exec python3 doc/make_reference.py`` generates doc/reference.md from docstrings and arguments of commands."""

import argparse
import ast
import re
import runpy
from pathlib import Path
from typing import Dict, Iterator, List, NamedTuple, Sequence, Tuple
from unittest import mock

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "doc" / "reference.md"
SECTIONS = (
    "Parameters",
    "Subscribes",
    "Publishes",
    "Services",
    "Services called",
    "Actions served",
    "Actions called",
)
_NAME = re.compile(r"([~/]?\w[\w/]*)(?: \(([^()]*)\))?(, |: |$)")
_ROLE = re.compile(r":\w+:`~?(?:[\w.]+\.)?(\w+)`")

INTRODUCTION = """\
# Reference: nodes and commands

The parameters, topics, services and actions of each node, and the arguments of each command. `--help` prints the same
texts. `./dev exec python3 doc/make_reference.py` generates this page from the docstrings; edit those instead.

Names are relative to the node's namespace and can be remapped; names with `~` are private to the node. Words in
capitals are placeholders. Each node reads its parameters when it starts. If some are invalid, it reports all of them
with their valid values, and exits. It warns of unknown parameters. The messages, services and actions of `rosoclingo/`
are in the folders `msg`, `srv` and `action`.
"""


class Node(NamedTuple):
    """A node of the page: its scripts, its default name, and the places of its docstrings (file, name)."""

    scripts: Tuple[str, ...]
    name: str
    places: Tuple[Tuple[str, str], ...]


class Entry(NamedTuple):
    """Names that one text describes, each with what stands in brackets behind it."""

    names: Tuple[Tuple[str, str], ...]
    text: str


class Description(NamedTuple):
    """A docstring: its words before the sections, the entries of each section, and the words behind."""

    words: str
    sections: Dict[str, List[Entry]]
    rest: str


INTERFACES = ("interface", "move_base_interface", "pickup_interface", "deliver_interface")
NODES = (
    Node(("core",), "rosoclingo", (("nodes/core/core_node.py", "CoreNode"),)),
    Node(
        INTERFACES,
        "that of the script",
        (("interfaces/hosting.py", "InterfacesNode"), ("interfaces/base.py", "Interface")),
    ),
    Node(("office",), "office", (("robot/nodes/office.py", "OfficeNode"),)),
    Node(("simulator",), "simulator", (("robot/nodes/stage/simulator_node.py", "SimulatorNode"),)),
    Node(("map_server",), "map_server", (("robot/nodes/map_server.py", "MapServerNode"),)),
    Node(("fake_localization",), "fake_localization", (("robot/nodes/localization.py", "FakeLocalizationNode"),)),
    Node(("move_base",), "move_base", (("robot/nodes/move_base/navigation_node.py", "MoveBaseNode"),)),
    Node(("markers",), "markers", (("nodes/rviz/markers.py", "MarkersNode"),)),
    Node(("web",), "web", (("nodes/pages/web_node.py", "WebNode"),)),
    Node(("record",), "record", (("nodes/recording/recorder.py", "RecorderNode"),)),
)
COMMANDS = {  # with what they have of ROS
    "request": (("nodes/request.py", "request"),),
    "play_scenario": (("nodes/scenarios/player.py", "ScenarioPlayer"), ("nodes/account_node.py", "AccountNode")),
    "check": (),
    "demo": (),
    "watch": (("nodes/account_node.py", "AccountNode"),),
    "replay": (),
    "report": (),
    "oclingo": (),
    "gringo3to5": (),
    "golog": (),
    "journal": (),
    "new": (),
    "places": (),
    "stage": (),
    "stage_world": (),
    "rviz_on_map": (),
}


def docstring(file: str, name: str) -> str:
    """The docstring of a class or function in a file of the package; nothing is imported."""
    tree = ast.parse((ROOT / "src" / "rosoclingo" / file).read_text(encoding="utf-8"))
    return next(ast.get_docstring(one) or "" for one in tree.body if getattr(one, "name", "") == name)


def describe(text: str) -> Description:
    """Read a docstring; raises ValueError for an entry that is none."""
    sections: Dict[str, List[List[str]]] = {}
    outside: List[List[str]] = [[], []]
    inside = ""
    for line in text.splitlines():
        if line.rstrip(":") in SECTIONS:
            inside = line.rstrip(":")
            sections[inside] = []
        elif inside and line.startswith("     "):
            sections[inside][-1].append(line.strip())
        elif inside and line.startswith("    "):
            sections[inside].append([line.strip()])
        elif set(line) != {"-"}:
            inside = inside if not line else ""
            outside[bool(sections)].append(line)
    entries = {name: [read_entry(" ".join(lines)) for lines in found] for name, found in sections.items()}
    return Description("\n".join(outside[0]).strip(), entries, "\n".join(outside[1]).strip())


def read_entry(line: str) -> Entry:
    """Read ``name (kind), other (kind): text``; a name without brackets has those of the next one."""
    names: List[Tuple[str, str]] = []
    at = 0
    while True:
        found = _NAME.match(line, at)
        if found is None:
            raise ValueError(f"no entry: {line}")
        names.append((found.group(1), found.group(2) or ""))
        at = found.end()
        if found.group(3) != ", ":
            break
    for index in range(len(names) - 2, -1, -1):
        names[index] = (names[index][0], names[index][1] or names[index + 1][1])
    return Entry(tuple(names), line[at:])


def descriptions(places: Sequence[Tuple[str, str]]) -> List[Description]:
    """The docstrings at some places."""
    return [describe(docstring(*place)) for place in places]


def entries(found: Sequence[Description], section: str) -> List[Entry]:
    """The entries of a section in some docstrings, none twice."""
    return list(dict.fromkeys(entry for one in found for entry in one.sections.get(section, ())))


def markdown(text: str) -> str:
    """Words of a docstring as Markdown."""
    return _ROLE.sub(r"`\1`", text).replace("``", "`")


def entry_line(entry: Entry) -> str:
    """An entry as a line of a list."""
    names = ", ".join(f"`{name}`" + (f" ({spec})" if spec else "") for name, spec in entry.names)
    return f"- {names}" + (f": {markdown(entry.text)}" if entry.text else "")


def section_lines(found: Sequence[Description]) -> Iterator[str]:
    """The sections of some docstrings, put together."""
    for section in SECTIONS:
        of_section = entries(found, section)
        if of_section:
            yield from ("", f"**{section}**", "", *map(entry_line, of_section))


def node_lines(node: Node) -> Iterator[str]:
    """The part of the page about a node."""
    yield from ("", f"### {', '.join(node.scripts)}", "")
    called = " or ".join(f"`rosrun rosoclingo {script}`" for script in node.scripts)
    yield f"{called}; default name: {node.name}."
    found = descriptions(node.places)
    yield from ("", markdown(found[0].words))
    yield from section_lines(found)
    if found[0].rest:
        yield from ("", markdown(found[0].rest))


class _Parser(Exception):  # noqa: N818 it carries the parser out of the script
    """The parser of a script, as soon as it is complete."""


def parser_of(script: str) -> argparse.ArgumentParser:
    """The parser of a command's arguments: the script is run until it has one."""

    def seize(parser: argparse.ArgumentParser, *_: object) -> None:
        """Stand in for what reads the arguments."""
        raise _Parser(parser)

    reading = dict.fromkeys(("parse_known_args", "parse_known_intermixed_args"), seize)
    with mock.patch.multiple(argparse.ArgumentParser, **reading):
        try:
            runpy.run_path(str(ROOT / "scripts" / script), run_name="__main__")
        except _Parser as found:
            parser: argparse.ArgumentParser = found.args[0]
            return parser
    raise ValueError(f"{script} has no parser")


def argument_lines(script: str) -> Iterator[str]:
    """The arguments of a command."""
    parser = parser_of(script)
    formatter = argparse.HelpFormatter(script)
    for action in parser._actions:
        if "--help" not in action.option_strings:
            shown = ", ".join(action.option_strings) or str(action.metavar or action.dest)
            if action.option_strings and action.nargs != 0:
                shown += f" {action.metavar or action.dest.upper()}"
            yield f"- `{shown}`: {formatter._expand_help(action)}"


def command_lines(script: str) -> Iterator[str]:
    """The part of the page about a command."""
    text = (ROOT / "scripts" / script).read_text(encoding="utf-8")
    own = describe(ast.get_docstring(ast.parse(text)) or "")
    yield from ("", f"### {script}", "", own.words, "", "**Arguments**", "", *argument_lines(script))
    yield from section_lines([own, *descriptions(COMMANDS[script])])


def page() -> str:
    """The whole page."""
    lines = [INTRODUCTION, "## Nodes"]
    for node in NODES:
        lines += node_lines(node)
    lines += ["", "## Commands", "", "`rosrun rosoclingo COMMAND --help` shows the arguments."]
    for script in COMMANDS:
        lines += command_lines(script)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
