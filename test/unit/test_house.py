"""The rules of CONTRIBUTING.md that a program can check."""

import ast
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from functools import lru_cache
from pathlib import Path

import pytest

pytestmark = pytest.mark.once
ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ROOT / "src" / "rosoclingo"
PURE = ("oclingo", "planning", "golog", "reasoning", "checking", "runs", "robot/navigation", "robot/simulation")
PURE_COMMON = ("database", "labels", "lazy", "reading")  # modules of common that pure packages can import
MAY_IMPORT = {  # layer by layer, and within oclingo and robot package by package
    "common": set(),
    "oclingo": {"oclingo/progression", "oclingo/program", "oclingo/solving"},  # errors for all, the front for users
    "oclingo/progression": {"oclingo"},
    "oclingo/program": {"oclingo", "oclingo/progression", "oclingo/gringo3"},
    "oclingo/gringo3": {"oclingo"},
    "oclingo/solving": {"oclingo", "oclingo/progression", "oclingo/program"},
    "oclingo/service": {"oclingo", "oclingo/progression", "oclingo/program", "oclingo/solving"},
    "planning": {"oclingo"},
    "golog": {"oclingo"},  # found by name at the place that reads a program's files
    "reasoning": {"common", "oclingo", "planning"},
    "checking": {"oclingo", "planning", "reasoning"},
    "runs": {"common", "oclingo", "planning", "reasoning", "checking"},
    "interfaces": {"common", "oclingo", "planning", "reasoning", "checking", "runs"},
    "nodes": {"common", "oclingo", "planning", "reasoning", "checking", "runs"},
    "robot": set(),
    "robot/navigation": {"common"},
    "robot/simulation": {"common", "robot/navigation"},
    "robot/nodes": {"common", "robot/navigation", "robot/simulation"},
}
LAYERS = {name.split("/")[0] for name in MAY_IMPORT}
GENERATED_FOLDERS = ("msg", "srv")
ROS_MODULES = re.compile(r"(ros\w*|actionlib|genpy|catkin\w*|tf|tf2\w*|\w+_msgs|\w+_srvs|message_filters)(\..*)?$")
GENERATED = re.compile(r"rosoclingo\.(msg|srv)(\..*)?$")
LIBRARIES = {  # the key in package.xml for each imported library; clingo comes only from PyPI
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "PIL": "python3-pil",
    "rospkg": "python3-rospkg",
    "scipy": "python3-scipy",
    "tornado": "python3-tornado",
    "yaml": "python3-yaml",
}
SOURCES = sorted(PACKAGES.rglob("*.py"))
PURE_SOURCES = [
    path for path in SOURCES if path.relative_to(PACKAGES).as_posix().startswith(tuple(f"{one}/" for one in PURE))
] + [PACKAGES / "common" / f"{name}.py" for name in PURE_COMMON]
SCRIPTS = sorted(path for path in (ROOT / "scripts").glob("*") if path.is_file())
TESTS = sorted(path for path in (ROOT / "test").rglob("*") if path.suffix == ".py")
LAUNCH_FILES = sorted((ROOT / "launch").glob("*.launch"))
ROSTESTS = sorted((ROOT / "test" / "rostest").rglob("*.test"))


def relative(path):
    return str(path.relative_to(ROOT))


def faults(paths, check):
    """Return the findings of a check by file, for files with any."""
    found = {relative(path): check(path) for path in paths}
    return {name: one for name, one in found.items() if one}


def statements(node):
    """Yield the statements below a node; a walk over all expressions takes ten times as long."""
    for field in ("body", "handlers", "orelse", "finalbody"):
        for child in getattr(node, field, ()):
            yield child
            yield from statements(child)


@lru_cache(maxsize=None)
def nodes_of(path):
    """Return the imports, functions and classes of a file."""
    kinds = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node for node in statements(ast.parse(path.read_text())) if isinstance(node, kinds)]


@lru_cache(maxsize=None)
def imports_of(path):
    """Return the absolute names of all modules that a file imports; for "from a import b" both a and a.b."""
    package = path.relative_to(ROOT / "src").with_suffix("").parts if path.suffix else ()
    names = set()
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level] if node.level else ()
            module = ".".join((*base, *([node.module] if node.module else [])))
            names.add(module)
            names.update(f"{module}.{alias.name}" for alias in node.names)
    return names


def room_of(parts):
    """Return the room of a module by its path or name below the package: the folder of MAY_IMPORT that contains it."""
    two = "/".join(parts[:2])
    return two if len(parts) > 1 and two in MAY_IMPORT else parts[0]


def rooms_of(names, within):
    """Return the rooms among imported names; from outside oclingo or robot each of them is one."""
    parts = [name.split(".")[1:] for name in names if name.startswith("rosoclingo.")]
    return {
        room_of(one) if one[0] == within.split("/")[0] else one[0]
        for one in parts
        if one[0] in {*LAYERS, *GENERATED_FOLDERS}
    }


def dependencies():
    root = ElementTree.parse(ROOT / "package.xml").getroot()
    return {element.text.strip() for element in root if element.tag.endswith("depend")}


@pytest.mark.slow
def test_house_imports_go_one_way():
    assert not faults(SOURCES, forbidden_rooms)


def forbidden_rooms(path):
    """Return the rooms from which a module must not import but does; top-level modules import none of them."""
    parts = path.relative_to(PACKAGES).with_suffix("").parts
    if len(parts) == 1:
        return rooms_of(imports_of(path), "")
    room = room_of(parts)
    allowed = MAY_IMPORT[room] | {room} | (set() if path in PURE_SOURCES else {*GENERATED_FOLDERS})
    return rooms_of(imports_of(path), room) - allowed


def test_house_modules_have_no_import_cycle():
    modules = {".".join(path.relative_to(ROOT / "src").with_suffix("").parts): path for path in SOURCES}
    modules = {
        name[: -len(".__init__")] if name.endswith(".__init__") else name: path for name, path in modules.items()
    }
    left = {name: imported_modules(path, modules) - {name} for name, path in modules.items()}
    while True:  # modules without a remaining import are not part of a cycle; imports for types count as well
        last = {name for name, imports in left.items() if not imports & left.keys()}
        if not last:
            break
        left = {name: imports for name, imports in left.items() if name not in last}
    assert not {name: imports & left.keys() for name, imports in left.items()}


def imported_modules(path, modules):
    """Return the modules that a file imports; for "from a import b" a.b if that is a module, else a."""
    found = set()
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in modules else node.module for name in inner}
    return found & modules.keys()


def test_house_pure_packages_use_neither_ros_nor_threads():
    assert not faults(PURE_SOURCES, impure_imports)


def impure_imports(path):
    """Return the forbidden imports of a pure module."""
    names = imports_of(path)
    impure = {name for name in names if ROS_MODULES.match(name) and not name.startswith("rosoclingo")}
    impure |= {name for name in names if GENERATED.match(name)}
    impure |= names & {"threading", "multiprocessing", "concurrent.futures", "queue"}
    return impure | {name.split(".")[2] for name in names if name.startswith("rosoclingo.common.")} - {*PURE_COMMON}


def test_house_rostests_have_folders_and_unique_names():
    rooms = {path.parent.relative_to(ROOT / "test" / "rostest").as_posix() for path in ROSTESTS}
    assert rooms == {"core", "interfaces", "nodes", "robot", "scenarios"}
    names = [path.name for path in (ROOT / "test" / "rostest").rglob("*") if path.suffix in (".py", ".test")]
    assert not {name for name in names if names.count(name) > 1}, "rostest finds scripts by their names"


def test_house_name_families_are_folders():
    assert not faults({path.parent for path in SOURCES}, families)


def families(folder):
    """Return the first words that more than two modules' names share."""
    first = [path.stem.split("_")[0] for path in folder.glob("*.py") if path.stem != "__init__"]
    return {word for word in first if first.count(word) > 2}


def test_house_setup_py_lists_every_subpackage():
    setuptools = pytest.importorskip("setuptools")
    folders = {".".join(path.parent.relative_to(ROOT / "src").parts) for path in SOURCES}
    assert set(setuptools.find_packages(str(ROOT / "src"))) == folders, "a folder with modules lacks __init__.py"
    assert 'find_packages("src")' in (ROOT / "setup.py").read_text()


def test_house_version_is_only_in_package_xml():
    version = ElementTree.parse(ROOT / "package.xml").getroot().findtext("version")
    for path in [ROOT / "setup.py", ROOT / "CMakeLists.txt", ROOT / "pyproject.toml", *SOURCES, *SCRIPTS]:
        text = path.read_text()
        assert "__version__" not in text, path
        assert f'"{version}"' not in text, path


@pytest.mark.slow
def test_house_scripts_and_functions_are_short():
    assert not [relative(path) for path in SCRIPTS if len(path.read_text().splitlines()) > 40]
    assert not faults(SOURCES + SCRIPTS + TESTS, long_functions)


def long_functions(path):
    functions = [node for node in nodes_of(path) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    return [node.name for node in functions if node.end_lineno - node.lineno >= 50]


def test_house_scripts_are_executable():
    for path in SCRIPTS:
        assert path.suffix == ""
        assert path.name != "rosoclingo", "it would shadow the package"
        assert path.stat().st_mode & 0o111 == 0o111, f"chmod +x {path}"
        assert path.read_text().startswith("#!/usr/bin/env python3\n"), path


def test_house_scripts_are_all_installed():
    listed = re.findall(r"^\s+scripts/(\S+)$", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)
    assert listed == sorted(listed)
    assert listed == [path.name for path in SCRIPTS], "catkin_install_python in CMakeLists.txt lists all of scripts/"


def test_house_interface_files_are_all_generated():
    for folder in ("action", "msg", "srv"):
        listed = re.findall(rf"^\s+(\w+\.{folder})$", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)
        assert listed == sorted(path.name for path in (ROOT / folder).glob(f"*.{folder}"))


def test_house_package_xml_names_the_imports():
    names = {name.split(".")[0] for path in SOURCES + SCRIPTS for name in imports_of(path)}
    needed = {LIBRARIES.get(name, name) for name in names if name in LIBRARIES or ROS_MODULES.match(name)}
    assert needed - {"rosoclingo", ""} <= dependencies()


def test_house_dev_knows_debian_package_of_dependencies():
    arrays = "\n".join(re.findall(r"^\w+_PACKAGES=\([^)]*\)", (ROOT / "dev").read_text(), re.MULTILINE))
    script = f'{arrays}\necho "${{DEBIAN_PACKAGES[@]}}" "${{COMMON_PACKAGES[@]}}"'
    packages = set(subprocess.run(["bash", "-c", script], check=True, capture_output=True, text=True).stdout.split())
    for key in dependencies() - {"python3-setuptools"}:
        name = key.replace("_", "-")
        assert packages & {name, f"python3-{name}", f"ros-{name}", f"lib{name}-dev", f"python3-{name}-python"}, key


def test_house_launch_arguments_are_documented():
    for path in LAUNCH_FILES:
        for argument in ElementTree.parse(path).getroot().findall("arg"):
            assert argument.get("doc") or "value" in argument.attrib, f"{path}: {argument.get('name')} lacks a doc text"


def test_house_launch_files_refer_to_existing_files():
    assert not faults(LAUNCH_FILES + ROSTESTS, missing_files)


def missing_files(path):
    """Return the files and nodes of this package that a launch file names but that do not exist."""
    elements = list(ElementTree.parse(path).getroot().iter())
    values = " ".join(value for element in elements for value in element.attrib.values())
    files = {ROOT / name for name in re.findall(r"\$\(find rosoclingo\)/([\w./-]+)", values)}
    for element in elements:
        kind = element.get("type", "$(")
        if element.tag == "node" and element.get("pkg") == "rosoclingo" and "$(" not in kind:
            own_folder = path in ROSTESTS and (path.parent / kind).exists()
            files.add((path.parent if own_folder else ROOT / "scripts") / kind)
    return [str(file) for file in files if not file.exists()]


def test_house_rostests_have_a_time_limit():
    for path in ROSTESTS:
        for element in ElementTree.parse(path).getroot().iter("test"):
            assert element.get("time-limit"), f"{path}: {element.get('test-name')} has no time limit"
