"""Whether a core that starts resumes from the journal that it finds, or begins a new run."""

from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

from rosoclingo.reasoning.journal.database import Header, JournalError, Kept, is_empty, launch_of
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.records import Record, group

#: ``yes``: resume; ``no``: begin a new run; ``ask``: resume if the same launch has begun the run.
RESUMES = ("ask", "yes", "no")


class Found(NamedTuple):
    """The journal that a core writes, and what it resumes.

    Attributes:
        journal: the journal, None if none is kept.
        run: the identity of the run.
        state: the state to resume from, None for a new run.
        remarks: what was found.
        odd: whether a remark is a warning.
        fault: why no journal is kept though one is wanted, empty otherwise.

    """

    journal: Optional[Journal]
    run: str
    state: Optional[Record] = None
    remarks: Sequence[str] = ()
    odd: bool = False
    fault: str = ""


def open_journal(folder: Optional[Path], resume: str, fresh: Header) -> Found:
    """Lock the journal in a folder, None for none; ``fresh`` is the header of a run that begins now.

    Raises JournalError if another core has it, or if the core should resume from it and cannot. If the folder cannot be
    written, the core goes on without a journal and reports the fault.
    """
    if folder is None:
        return Found(None, fresh.run)
    place: Optional[Journal] = None
    try:
        place = Journal(folder, fresh)
        return _open(place, resume, fresh)
    except (OSError, JournalError) as error:
        if place is not None:
            place.close()
        if isinstance(error, JournalError):
            raise
        mend = "~journal names another folder, or none"
        return Found(None, fresh.run, fault=f"no journal is kept in {folder}: {error.strerror} ({mend})")


def _open(place: Journal, resume: str, fresh: Header) -> Found:
    if is_empty(place.path):
        stale = Path(f"{place.path}.stale")
        odd = [f"nothing is resumed: the disk failed before {stale} could have all"] if stale.exists() else []
        return Found(place, fresh.run, None, odd, bool(odd))
    own = launch_of(place.path) == fresh.launch != ""
    if resume == "no" or (resume == "ask" and not own):
        return _begin_anew(place, resume, fresh)
    kept = place.read()
    assert kept is not None
    if kept.header.program != fresh.program:
        mend = "start with that one, or without the journal (~resume: no), or give another folder (~journal)"
        raise JournalError(f"{place.path} is of another program (files, constants or labels): {mend}")
    place.header = fresh._replace(run=kept.header.run)
    return Found(place, place.header.run, kept.state, [f"goes on with {place.path}: {_described(kept)}"])


def _begin_anew(place: Journal, resume: str, fresh: Header) -> Found:
    """Set the journal aside; warn if it has open goals that nobody has asked to forget."""
    try:
        kept = place.read()
        open_goals, described = any(_open_goals(kept)) if kept else False, _described(kept) if kept else ""
    except JournalError as error:
        open_goals, described = True, str(error)
    aside = place.set_aside("old")
    odd = open_goals and resume == "ask"
    back = f"to go on with it stop the core, move {aside} to {place.path} and start with ~resume: yes"
    remarks = [f"begins anew; the journal of another launch ({described}) is {aside} now: {back}"] if odd else []
    return Found(place, fresh.run, None, remarks, odd)


def _open_goals(kept: Kept) -> List[str]:
    return list(group(kept.state, "goal"))


def _described(kept: Kept) -> str:
    goals, cycle = len(_open_goals(kept)), max(1, kept.state["core"]["step"])
    return f"run {kept.header.run}, cycle {cycle}, {goals} open goal{'s' * (goals != 1)}"
