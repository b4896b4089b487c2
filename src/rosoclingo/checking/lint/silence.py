"""Comments that silence findings: ``% check: ok unused`` on the line, or alone on the line before."""

import re
from typing import Dict, Iterable, List, Set, Tuple

from rosoclingo.checking.lint.kinds import KINDS
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import likely_word

_COMMENT = re.compile(r"[%#]\s*check:\s*ok\b(?P<kinds>[^(\n]*)")
_ALONE = re.compile(r"\s*[%#]\s*check:\s*ok\b")
_WORD = re.compile(r"[^\s,;]+")


class Silences:
    """Where which kinds of findings are silenced; a reason in round brackets may stand behind the kinds."""

    def __init__(self, texts: Iterable[Tuple[str, str]]) -> None:
        """Take files by their names and texts."""
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
        mend = "write % check: ok KIND, with the kind that a finding has at its end in square brackets"
        if not kinds:
            self.faults.append(Fault(name, line, column, "nothing is silenced: no kind is named", mend, "silence"))
        for kind in kinds:
            if kind not in KINDS:
                told = likely_word(kind, KINDS) or mend
                self.faults.append(Fault(name, line, column, f"there is no kind {kind} of findings", told, "silence"))

    def covers(self, fault: Fault) -> bool:
        """Tell whether a finding is silenced."""
        return fault.kind in self._kinds.get((fault.file, fault.line), ())
