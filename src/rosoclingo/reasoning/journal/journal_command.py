"""The command ``journal``: shows or removes the journal of a core."""

import sys
from pathlib import Path

from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.reasoning.journal.database import JournalError, file_of, lines_of, read
from rosoclingo.reasoning.journal.folder import Journal

#: The subcommands.
VERBS = ("show", "clear")


@exits_on_broken_pipe
def main(verb: str, name: str) -> int:
    """Show or clear the journal in a folder; return the exit code.

    Renamed journals and the journal of a running core can be shown, too. The journal of a running core cannot be
    cleared.
    """
    try:
        return _show(Path(name)) if verb == "show" else _clear(Path(name))
    except BrokenPipeError:
        raise
    except OSError as error:
        return _failed(f"{error.filename or name}: {error.strerror}")
    except JournalError as error:
        return _failed(str(error))


def _show(path: Path) -> int:
    file = file_of(path)
    try:
        content = read(file)
    except JournalError as error:
        raise JournalError(f"{file}: {error}") from None
    sys.stdout.writelines(f"{line}\n" for line in lines_of(content))
    return 0


def _clear(path: Path) -> int:
    if not path.is_dir():
        return _failed(f"{path} is not a folder with a journal")
    folder = Journal(path)
    try:
        names = ", ".join(folder.clear())
    finally:
        folder.close()
    sys.stdout.write(f"removed {names}\n" if names else f"there is no journal in {path}\n")
    return 0


def _failed(why: str) -> int:
    sys.stderr.write(f"journal: {why}\n")
    return 1
