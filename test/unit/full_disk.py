"""A full disk, for the files that a process writes."""

import resource
from contextlib import contextmanager, suppress

THIS_PROCESS = 0


@contextmanager
def room_for(size, process=THIS_PROCESS):
    """Limit the files of a process to ``size`` bytes, for any user: EFBIG stands for ENOSPC."""
    before = resource.prlimit(process, resource.RLIMIT_FSIZE)
    resource.prlimit(process, resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        with suppress(ProcessLookupError):  # it was perhaps killed
            resource.prlimit(process, resource.RLIMIT_FSIZE, before)
