"""Whether a core that starts goes on with the journal that it finds, or begins anew."""

from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

from rosoclingo.common import durable
from rosoclingo.reasoning.journal.folder import AnyJournal, Journal, JournalFolder, NoJournal
from rosoclingo.reasoning.journal.lines import Header, JournalError, Kept, State, launch_of
from rosoclingo.reasoning.records import group

#: ``yes``: go on with what is there; ``no``: begin anew; ``ask``: go on where the same launch has begun it.
RESUMES = ("ask", "yes", "no")


class Found(NamedTuple):
    """The ``journal`` to write, the ``run`` that it is of, and the ``state`` to go on from, None to begin anew.

    ``remarks`` say what was found; where one is ``odd``, it is a warning.
    """

    journal: Optional[AnyJournal]
    run: str
    state: Optional[State] = None
    remarks: Sequence[str] = ()
    odd: bool = False

    @property
    def doubtful(self) -> bool:
        """Whether more may have gone out than the state has: the machine was started anew since."""
        return self.state is not None and (durable.machine() or "") != self.state.get("machine")


def open_journal(folder: Optional[Path], resume: str, fresh: Header) -> Found:
    """Take the journal in a folder, None for none; ``fresh`` is the header of a run that begins now.

    Raises JournalError where another core has it, or where it cannot be used though it should be. Of a folder that
    cannot be written the journal tells: the core goes on without.
    """
    if folder is None:
        return Found(None, fresh.run)
    try:
        place = JournalFolder(folder)
    except OSError as error:
        return _none(folder, error, fresh)
    try:
        return _open(place, resume, fresh)
    except OSError as error:
        place.close()
        return _none(folder, error, fresh)
    except JournalError:
        place.close()
        raise


def _none(folder: Path, error: OSError, fresh: Header) -> Found:
    mend = "~journal names another folder, or none"
    return Found(NoJournal(f"no journal is kept in {folder}: {error.strerror} ({mend})"), fresh.run)


def _open(place: JournalFolder, resume: str, fresh: Header) -> Found:
    if not place.path.exists():
        stale = Path(f"{place.path}.stale")
        odd = [f"nothing is resumed: the disk failed before {stale} could have all"] if stale.exists() else []
        return Found(Journal(place, fresh), fresh.run, None, odd, bool(odd))
    own = launch_of(place.path.read_bytes()) == fresh.launch != ""
    if resume == "no" or (resume == "ask" and not own):
        return _begin_anew(place, resume, fresh)
    kept = place.read()
    assert kept is not None
    if kept.header.program != fresh.program:
        mend = "start with that one, or without the journal (~resume: no), or give another folder (~journal)"
        raise JournalError(f"{place.path} is of another program (files, constants or labels): {mend}")
    header = fresh._replace(run=kept.header.run)
    return Found(Journal(place, header), header.run, kept.state, [f"goes on with {place.path}: {_told(kept)}"])


def _begin_anew(place: JournalFolder, resume: str, fresh: Header) -> Found:
    """Set the journal aside; where goals are open in it and nobody has said that they are to be forgotten, tell it."""
    try:
        kept = place.read()
        open_goals, told = any(_open_goals(kept)) if kept else False, _told(kept) if kept else ""
    except JournalError as error:
        open_goals, told = True, str(error)
    aside = place.set_aside("old")
    odd = open_goals and resume == "ask"
    back = f"to go on with it stop the core, move {aside} to {place.path} and start with ~resume: yes"
    remarks = [f"begins anew; the journal of another launch ({told}) is {aside} now: {back}"] if odd else []
    return Found(Journal(place, fresh), fresh.run, None, remarks, odd)


def _open_goals(kept: Kept) -> List[str]:
    return list(group(kept.state, "goal"))


def _told(kept: Kept) -> str:
    goals = len(_open_goals(kept))
    return f"run {kept.header.run}, cycle {max(1, kept.state['core'][1])}, {goals} open goal{'s' * (goals != 1)}"
