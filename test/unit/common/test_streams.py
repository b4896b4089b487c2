"""What is said on a full disk costs nobody anything but the words."""

import resource
import subprocess
import sys
from pathlib import Path

import pytest

from rosoclingo.common.streams import LenientStream

SPEAKER = """
import logging, sys
from rosgraph.roslogging import RosStreamHandler
from rosoclingo.common.streams import tolerate_full_disk
tolerate_full_disk()
log = logging.getLogger("rosout")
log.setLevel(logging.INFO)
log.addHandler(RosStreamHandler())
for number in range(3):
    log.error("error %d", number)
    log.info("info %d", number)
    sys.stdout.flush()
"""


@pytest.mark.slow
def test_rospys_log_on_a_full_disk_raises_nothing():
    with open("/dev/full", "w") as full:
        assert subprocess.run([sys.executable, "-c", SPEAKER], stdout=full, stderr=full, timeout=60).returncode == 0


def test_what_comes_once_there_is_room_is_there(tmp_path):
    path = Path(tmp_path, "log")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    with open(path, "w") as file:
        stream = LenientStream(file)
        assert stream.write("first\n") == 6
        stream.flush()
        resource.setrlimit(resource.RLIMIT_FSIZE, (6, limit[1]))
        try:
            stream.write("second\n")
            stream.flush()
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        stream.write("third\n")
        stream.flush()
        assert stream.fileno() == file.fileno(), "all else is as it was"
    assert path.read_text().startswith("first\n")
    assert path.read_text().endswith("third\n")
