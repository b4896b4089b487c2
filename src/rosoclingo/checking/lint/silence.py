"""Comments that silence findings: ``% check: ok unused`` on the same line, or alone on the previous line."""

import re
from typing import Dict, Iterable, List, Set, Tuple

from rosoclingo.checking.lint.kinds import KINDS
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import likely_word

_COMMENT = re.compile(r"[%#]\s*check:\s*ok\b(?P<kinds>[^(\n]*)")
_ALONE = re.compile(r"\s*[%#]\s*check:\s*ok\b")
_WORD = re.compile(r"[^\s,;]+")


class Silences:
    """The silenced kinds of findings by line.

    A comment can end with a reason in parentheses, which is ignored.

    Attributes:
        faults: comments that name no kind, or an unknown one.

    """

    def __init__(self, texts: Iterable[Tuple[str, str]]) -> None:
        """Read the comments of files, given as names and texts."""
        self._kinds: Dict[Tuple[str, int], Set[str]] = {}
        self.faults: List[Fault] = []
        for name, text in texts:
            if "check:" in text:
                self._read(name, text)

    def _read(self, name: str, text: str) -> None:
        for number, line in enumerate(text.splitlines(), 1):
            match = _COMMENT.search(line)
            if match is not None:
                kinds = _WORD.findall(match.group("kinds"))
                self._judge(name, number, match.start() + 1, kinds)
                self._kinds.setdefault((name, number), set()).update(kinds)
                if _ALONE.match(line):
                    self._kinds.setdefault((name, number + 1), set()).update(kinds)

    def _judge(self, name: str, line: int, column: int, kinds: List[str]) -> None:
        remedy = "write % check: ok KIND, with the kind in square brackets at the end of the finding"
        if not kinds:
            self.faults.append(Fault(name, line, column, "the comment names no kind", remedy, "silence"))
        for kind in kinds:
            if kind not in KINDS:
                hint = likely_word(kind, KINDS) or remedy
                self.faults.append(Fault(name, line, column, f"there is no kind {kind} of findings", hint, "silence"))

    def covers(self, fault: Fault) -> bool:
        """Return whether a finding is silenced."""
        return fault.kind in self._kinds.get((fault.file, fault.line), ())
