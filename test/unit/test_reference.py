"""doc/reference.md equals the docstrings, and the parameters in it are those that the nodes read."""

import importlib
import runpy
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
MAKER = runpy.run_path(str(ROOT / "doc" / "make_reference.py"))
NODES = {node.scripts[0]: node for node in MAKER["NODES"]}
KINDS = {"str": str, "int": int, "float": float, "bool": bool, "list": list, "list of str": list, "map": dict}
#: The value that stands in for a name that the parameters give.
GIVEN_NAMES = {"SOURCE": "base_scan"}


class ParametersReadError(Exception):  # noqa: N818 it ends a node's start, not an error
    """Raised when a node has read all its parameters."""


@pytest.fixture
def read_parameters(monkeypatch, messages):
    """Start a node of a class until it has read its parameters; return their names and the defaults."""
    import rospy

    tf2_ros = pytest.importorskip("tf2_ros", reason="compiled, and not for this Python")
    from rosoclingo.common import parameters
    from rosoclingo.common.reading import Reader

    def start(file, name):
        seen, defaults = set(), {}
        read = Reader.read

        def noting(reader, wanted, fit, default=None, empty=None):
            defaults[reader.place] = default
            return read(reader, wanted, fit, default, empty)

        def stop(given, error=None):
            raise ParametersReadError

        monkeypatch.setattr(parameters, "_READ", seen)
        monkeypatch.setattr(rospy, "get_param", lambda name, default=None: default)
        monkeypatch.setattr(tf2_ros, "Buffer", lambda: None)
        monkeypatch.setattr(tf2_ros, "TransformListener", lambda *_: None)
        monkeypatch.setattr(Reader, "read", noting)
        monkeypatch.setattr(parameters.Parameters, "check", stop)
        module = importlib.import_module("rosoclingo." + file[:-3].replace("/", "."))
        with pytest.raises(ParametersReadError):
            getattr(module, name)()
        return seen, defaults

    return start


def documented(node):
    """Return the parameters of a node by name, each with the text in its brackets."""
    entries = MAKER["entries"](MAKER["descriptions"](node.places), "Parameters")
    return {concrete(name): spec for entry in entries for name, spec in entry.names}


def concrete(name):
    for word, given in GIVEN_NAMES.items():
        name = name.replace(word, given)
    return name


def test_reference_page_equals_the_docstrings(messages):
    assert MAKER["page"]() == MAKER["PAGE"].read_text(encoding="utf-8"), "regenerate it: doc/make_reference.py"


def test_reference_page_has_every_script():
    scripts = [script for node in MAKER["NODES"] for script in node.scripts] + list(MAKER["COMMANDS"])
    assert sorted(scripts) == sorted(path.name for path in (ROOT / "scripts").iterdir() if path.is_file())


@pytest.mark.parametrize("script", MAKER["COMMANDS"])
def test_reference_page_has_arguments_of_every_command(script):
    part = MAKER["PAGE"].read_text(encoding="utf-8").partition(f"\n### {script}\n")[2].partition("\n### ")[0]
    assert "\n**Arguments**\n\n- `" in part


@pytest.mark.parametrize("script", sorted(NODES))
def test_reference_script_starts_node_of_its_docstring(script):
    file, name = NODES[script].places[0]
    text = (ROOT / "scripts" / script).read_text() + (ROOT / "src" / "rosoclingo" / file).read_text()
    assert f"node_arguments({name}, " in text


@pytest.mark.parametrize("script", sorted(NODES))
def test_reference_parameters_are_those_of_the_node(script, read_parameters):
    seen, defaults = read_parameters(*NODES[script].places[0])
    names = {"~" + name for name in seen} | {place for place in defaults if place.startswith("~")}
    groups = {name for name in names if any(other.startswith(name + "/") for other in names)}
    assert names - groups == set(documented(NODES[script]))


@pytest.mark.parametrize("script", sorted(NODES))
def test_reference_defaults_are_those_of_the_code(script, read_parameters):
    _, defaults = read_parameters(*NODES[script].places[0])
    from rosoclingo.common.reading import MISSING

    for name, spec in documented(NODES[script]).items():
        kind, _, rest = spec.partition(", ")
        read = defaults.get(name)
        if rest == "optional":
            continue
        if rest == "required":
            assert read is MISSING, name
            continue
        word, _, default = rest.partition(" ")
        assert word == "default", f"{name} ({spec})"
        value = yaml.safe_load(default)
        assert name in defaults, f"{name} is never asked for"
        assert value == (list(read) if isinstance(read, tuple) else read), name
        assert type(value) is KINDS[kind], name
