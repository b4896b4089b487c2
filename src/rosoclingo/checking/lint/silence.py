"""Comments that silence findings: ``% check: ok unused`` on the same line, or alone on the previous line."""

import re
from typing import Dict, Iterable, List, Set, Tuple

from rosoclingo.checking.lint.kinds import KINDS
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import likely_word

_COMMENT = re.compile(r"[%#]\s*check:\s*ok\b(?P<kinds>[^(\n]*)")
_ALONE = re.compile(r"\s*[%#]\s*check:\s*ok\b")
_WORD = re.compile(r"[^\s,;]+")


def read_silences(texts: Iterable[Tuple[str, str]]) -> Tuple[Dict[Tuple[str, int], Set[str]], List[Fault]]:
    """Return the silenced kinds by file and line, and the comments that name no kind or an unknown one.

    ``texts`` are names and texts of files. A comment can end with a reason in parentheses, which is ignored.
    """
    silenced: Dict[Tuple[str, int], Set[str]] = {}
    faults: List[Fault] = []
    remedy = "write % check: ok KIND, with the kind in square brackets at the end of the finding"
    for name, text in texts:
        for number, line in enumerate(text.splitlines() if "check:" in text else (), 1):
            match = _COMMENT.search(line)
            if match is None:
                continue
            kinds, place = _WORD.findall(match.group("kinds")), (name, number, match.start() + 1)
            if not kinds:
                faults.append(Fault(*place, "the comment names no kind", remedy, "silence"))
            for kind in (one for one in kinds if one not in KINDS):
                hint = likely_word(kind, KINDS) or remedy
                faults.append(Fault(*place, f"there is no kind {kind} of findings", hint, "silence"))
            for covered in (number, number + 1) if _ALONE.match(line) else (number,):
                silenced.setdefault((name, covered), set()).update(kinds)
    return silenced, faults
