"""Pages about `check`: their files are written, their commands run, and the outputs compared."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from rosoclingo.checking.lint.kinds import KINDS

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("check.md", "why_no_plan.md", "verify.md")
PAGE, WHY, VERIFY = ((ROOT / "doc" / name).read_text(encoding="utf-8") for name in NAMES)
FILES = {
    PAGE: ["lamp.lp", "evening.txt", "light.lp", "labels.yaml", "interfaces.yaml", "orders.yaml"],
    WHY: ["rooms.lp", "evening.txt"],
    VERIFY: ["rooms.lp", "open.lp"],
}
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_check_page_table_lists_the_kinds():
    rows = re.findall(r"^\| `([\w-]+)` \| (\w+) \| \S.* \|$", PAGE, re.MULTILINE)
    assert sorted(rows) == sorted(KINDS.items())


def matches(shown, printed):
    """Return whether a command's output matches the page; three dots stand for any lines."""
    pattern = "".join(r"(.*\n)*" if line == "..." else re.escape(line) + "\n" for line in shown.splitlines())
    return re.fullmatch(pattern, printed) is not None


@pytest.mark.slow
@pytest.mark.parametrize("page", [PAGE, WHY, VERIFY], ids=["check", "why_no_plan", "verify"])
def test_check_page_shows_the_real_output(tmp_path, page):
    pytest.importorskip("genpy", reason="message types are checked")
    files, commands, end = [], 0, 0
    for match in BLOCK.finditer(page):
        before = page[end : match.start()].strip().rpartition("\n\n")[2]
        named = re.search(r"`(\w+\.\w+)`[^`]*:\Z|\A`(\w+\.\w+)`", before)
        if match.group(1) != "console" and named:
            files.append(named.group(1) or named.group(2))
            (tmp_path / files[-1]).write_text(match.group(2), encoding="utf-8")
        elif match.group(1) == "console":
            first, _, shown = match.group(2).partition("\n")
            words = shlex.split(first)
            assert words[:3] == ["$", "rosrun", "rosoclingo"]
            command = [sys.executable, str(ROOT / "scripts" / words[3]), *words[4:]]
            done = subprocess.run(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, check=False, timeout=300)
            assert done.returncode in (0, 1)
            assert matches(shown, done.stdout), f"{first}\n{done.stdout}"
            commands += 1
        end = match.end()
    assert files == FILES[page]
    assert commands == page.count("\n$ ") >= 2
