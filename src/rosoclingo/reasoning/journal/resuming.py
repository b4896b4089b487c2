"""The decision at the start of a core: resume from a journal, or begin a new run."""

from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

from rosoclingo.reasoning.journal.database import Header, JournalContent, JournalError, is_empty, launch_of
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.records import Record, group

#: ``yes``: resume; ``no``: begin a new run; ``ask``: resume if the same launch began the run.
RESUMES = ("ask", "yes", "no")


class OpenedJournal(NamedTuple):
    """The journal that a core writes, and the state that it resumes from.

    Attributes:
        journal: the journal, None if none is kept.
        run: the identity of the run.
        state: the state to resume from, None for a new run.
        remarks: messages for the log.
        odd: whether a remark is a warning.
        fault: why a requested journal is missing, empty for none.

    """

    journal: Optional[Journal]
    run: str
    state: Optional[Record] = None
    remarks: Sequence[str] = ()
    odd: bool = False
    fault: str = ""


def open_journal(folder: Optional[Path], resume: str, fresh: Header) -> OpenedJournal:
    """Lock the journal in a folder, None for none; ``fresh`` is the header of a new run.

    Raises JournalError if another core uses it, or if the core has to resume from it and cannot. If the folder is not
    writable, the core runs without a journal and reports the fault.
    """
    if folder is None:
        return OpenedJournal(None, fresh.run)
    place: Optional[Journal] = None
    try:
        place = Journal(folder, fresh)
        return _open(place, resume, fresh)
    except (OSError, JournalError) as error:
        if place is not None:
            place.close()
        if isinstance(error, JournalError):
            raise
        remedy = "set ~journal to another folder, or to none"
        return OpenedJournal(None, fresh.run, fault=f"no journal is kept in {folder}: {error.strerror} ({remedy})")


def _open(place: Journal, resume: str, fresh: Header) -> OpenedJournal:
    if is_empty(place.path):
        stale = Path(f"{place.path}.stale")
        odd = [f"nothing is resumed: the disk failed before {stale} was complete"] if stale.exists() else []
        return OpenedJournal(place, fresh.run, None, odd, bool(odd))
    own = launch_of(place.path) == fresh.launch != ""
    if resume == "no" or (resume == "ask" and not own):
        return _begin_run(place, resume, fresh)
    content = place.read()
    assert content is not None
    if content.header.program != fresh.program:
        remedy = "start that program, ignore the journal (~resume: no), or set another folder (~journal)"
        raise JournalError(f"{place.path} belongs to another program (files, constants or labels): {remedy}")
    place.header = fresh._replace(run=content.header.run)
    return OpenedJournal(place, place.header.run, content.state, [f"resumes from {place.path}: {_described(content)}"])


def _begin_run(place: Journal, resume: str, fresh: Header) -> OpenedJournal:
    """Rename the journal and begin a new run; warn if the journal has open goals and ``resume`` is ``ask``."""
    try:
        content = place.read()
        open_goals, described = any(_open_goals(content)) if content else False, _described(content) if content else ""
    except JournalError as error:
        open_goals, described = True, str(error)
    aside = place.set_aside("old")
    odd = open_goals and resume == "ask"
    back = f"to resume it, stop the core, move {aside} to {place.path} and start with ~resume: yes"
    remark = f"beginning a new run; the journal of another launch ({described}) is now {aside}: {back}"
    remarks = [remark] if odd else []
    return OpenedJournal(place, fresh.run, None, remarks, odd)


def _open_goals(content: JournalContent) -> List[str]:
    return list(group(content.state, "goal"))


def _described(content: JournalContent) -> str:
    goals, cycle = len(_open_goals(content)), max(1, content.state["core:step"])
    return f"run {content.header.run}, cycle {cycle}, {goals} open goal{'s' * (goals != 1)}"
