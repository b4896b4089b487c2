"""A full disk, for the files that this process writes."""

import resource
from contextlib import contextmanager


@contextmanager
def room_for(size):
    """Limit files of this process to ``size`` bytes: EFBIG stands for ENOSPC."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
