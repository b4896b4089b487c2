"""The documents: every page is in the index, every link has a target, and the drawing of a request's way is right."""

import ast
import re
import textwrap
from pathlib import Path

from test_house import imports_of

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_updates, solving

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "rosoclingo"
SITE = {ROOT / "doc" / "index.md", ROOT / "doc" / "contributing.md"}  # only for the site: its text comes from the root
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted({*(ROOT / "doc").glob("*.md")} - SITE)]
LINK = re.compile(r"\]\(([^)\s]+)\)")
#: A file of the repository, from its root.
FILE = re.compile(
    r"(?<![\w/.:-])(?:bench|config|doc|encodings|launch|scripts|test|worlds|src/rosoclingo)/[\w./-]*\.[a-z]+\b"
)
STEP = re.compile(r"(?P<lead>[ |]*)(?:\+(?P<arrow>-->|\.\.>|==>|~~>) )?(?P<file>[\w/]+\.py)(?P<words>  .*)?")


def prose(path):
    """Return a page's text without its code blocks, fenced or indented."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^    .*$", "", text, flags=re.MULTILINE)


def anchors(path):
    """Return the anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", prose(path), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def links(path):
    return [one for one in LINK.findall(prose(path)) if not re.match(r"\w+:", one)]


def has_target(path, link):
    """Return whether the target of a page's link exists."""
    name, _, anchor = link.partition("#")
    target = (path.parent / name).resolve() if name else path
    return target.exists() and (not anchor or anchor in anchors(target))


def test_documents_links_have_targets():
    assert not [(path.name, link) for path in PAGES for link in links(path) if not has_target(path, link)]


def test_documents_name_existing_files():
    for path in PAGES:
        for name in FILE.findall(path.read_text(encoding="utf-8")):
            from_workspace = name.replace("src/rosoclingo/", "", 1)  # where this folder is src/rosoclingo
            assert (ROOT / name).is_file() or (ROOT / from_workspace).is_file(), (path.name, name)


def test_documents_index_has_every_page():
    index = ROOT / "doc" / "README.md"
    listed = {(index.parent / link.partition("#")[0]).resolve() for link in links(index)}
    assert set(PAGES) - {index} <= listed

    assert "doc/README.md" in {link.partition("#")[0] for link in links(ROOT / "README.md")}


def test_documents_site_has_every_page():
    text = (ROOT / "doc" / "index.md").read_text(encoding="utf-8")
    trees = re.findall(r"^```{toctree}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    listed = [line for tree in trees for line in tree.splitlines() if re.fullmatch(r"\w+", line)]
    own = {path.stem for path in (ROOT / "doc").glob("*.md")} - {"README", "index"}
    assert sorted(listed) == sorted({*own, "api"})


# ---- reliability
# ----------------------------------------------------------------------------------------------------


def promises():
    """Yield for each line of the tables the failure, and the names of its tests, which are in the last column."""
    text = (ROOT / "doc" / "reliability.md").read_text(encoding="utf-8")
    rows = [line.strip("|").split("|") for line in text.splitlines() if re.match(r"\|(?!---| What )", line)]
    return [(row[0].strip(), re.findall(r"`(\w+)`", row[-1])) for row in rows]


def test_documents_reliability_promises_have_tests():
    assert len(promises()) > 20
    assert [row for row, names in promises() if not names] == []
    files = {path.name for folder in ("unit", "rostest") for path in (ROOT / "test" / folder).rglob("*.*")}
    suffix = {True: ".py", False: ".test"}
    named = [(row, name + suffix[name.startswith("test_")]) for row, names in promises() for name in names]
    assert not [one for one in named if one[1] not in files]


# ---- the tree of packages
# -------------------------------------------------------------------------------------------


def test_documents_package_tree_is_complete():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("    src/rosoclingo/\n")[2]
    drawn, room = set(), ""
    for line in text.partition("\n    web/")[0].splitlines():
        entry = re.match(r"( {8}| {12})([a-z0-9_]+)/ +\S", line)
        if entry:
            room = entry[2] if len(entry[1]) == 8 else room
            drawn.add(entry[2] if entry[2] == room else f"{room}/{entry[2]}")
    there = {str(path.parent.relative_to(PACKAGE)) for path in PACKAGE.rglob("__init__.py")} - {"."}
    assert drawn == {name for name in there if name.count("/") < 2}


# ---- the way of a request -------------------------------------------------------------------------------------------


def drawing():
    """Return the lines of the drawing: (parent's file, arrow, file, words), the parent empty for the first."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## The way of a request")[2]
    block = text.partition("```text\n")[2].partition("```")[0]
    found, above = [], {}
    for line in block.splitlines():
        step = STEP.fullmatch(line)
        assert step, f"no line of the drawing: {line}"
        depth = len(step["lead"]) + (2 if step["arrow"] else 0)
        above = {place: file for place, file in above.items() if place < depth}
        found.append((above[max(above)] if above else "", step["arrow"], step["file"], step["words"]))
        above[depth] = step["file"]
    return found


def module(file):
    return "rosoclingo." + file[: -len(".py")].replace("/", ".")


def imports(file, other):
    """Return whether a file imports another one, or a name of its package's __init__."""
    found, front = imports_of(PACKAGE / file), (PACKAGE / other).parent / "__init__.py"
    package, name = module(other).rsplit(".", 1)
    given = {one.rsplit(".", 1)[1] for one in imports_of(front) if one.startswith(f"{package}.{name}.")}
    return module(other) in found or bool(found & {f"{package}.{one}" for one in given})


def texts_of(file):
    """Return the texts in a file and in those that it imports from its own folder."""
    siblings = [path for path in (PACKAGE / file).parent.glob("*.py") if module_of(path) in imports_of(PACKAGE / file)]
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in (PACKAGE / file, *siblings)]
    constants = [one.value for tree in trees for one in ast.walk(tree) if isinstance(one, ast.Constant)]
    return {value for value in constants if isinstance(value, str)}


def module_of(path):
    return module(path.relative_to(PACKAGE).as_posix())


def test_documents_drawing_shows_the_whole_way():
    lines = drawing()
    assert len(lines) > 10
    assert [line for line in lines if not line[1]] == lines[:1], "one root"
    assert {line[1] for line in lines} == {None, "-->", "..>", "==>", "~~>"}
    assert all((PACKAGE / line[2]).is_file() for line in lines)


def test_documents_drawing_arrows_are_in_the_code():
    for parent, arrow, file, words in drawing()[1:]:
        assert imports(parent, file) == (arrow == "-->"), (parent, file)
        if arrow == "..>":
            assert imports(drawing()[0][2], file), f"{file} is handed over by the root"
        elif arrow == "==>":
            assert module(file) in texts_of(parent), f"{parent} starts {file} by its name"
        elif arrow == "~~>":
            topic = words.partition(":")[0].split()[-1]
            assert topic in texts_of(parent) & texts_of(file), (topic, parent, file)


# ---- the solver's loop ----------------------------------------------------------------------------------------------


def code_of(text):
    """Return the indented blocks of a text."""
    return textwrap.dedent("\n".join(line for line in text.splitlines() if not line or line.startswith("    ")))


def lift():
    """Return the program of doc/oclingo_service.md, its stream, and the answers on the page."""
    text = (ROOT / "doc" / "oclingo_service.md").read_text(encoding="utf-8")
    program, stream = text.split("```\n")[1:4:2]
    return ReactiveProgram.from_text(program), parse_updates(stream)


def test_documents_solver_loop_runs():
    room = {}
    exec(code_of(solving.__doc__), room)  # noqa: S102 it is the code under test
    program, stream = lift()
    loop, solver = room["Loop"](program), ReactiveSolver(program)
    answers = [sorted(map(str, loop.update(update))) for update in stream]
    assert answers == [["up(1)", "up(2)"], ["down(3)", "down(4)", "up(1)", "up(2)"]]
    assert loop.horizon == 4
    assert answers == [sorted(map(str, solver.update(update).answers[0])) for update in stream]

    assert len([line for line in code_of(solving.__doc__).splitlines() if line.strip()]) <= 40
    here = {path.name for path in (PACKAGE / "oclingo" / "solving").glob("*.py")}
    named = set(re.findall(r"(?<![/\w])\w+\.py\b", solving.__doc__))
    assert named
    assert named <= here
