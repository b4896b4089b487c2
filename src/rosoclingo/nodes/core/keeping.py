"""Where the core's journal lies, and which launch it is of."""

import os
import re
import sys
import time
import uuid
from pathlib import Path
from typing import Optional

import rosgraph
import rospkg
import rospy

from rosoclingo.nodes.core.loading import AUTO, NONE, CoreParameters
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import LockedError, tidy
from rosoclingo.reasoning.journal.resuming import OpenedJournal, open_journal
from rosoclingo.runs.recorded_run import RunProgram

#: Seconds of wall time for another core to leave the journal.
TAKEN = 10.0


def find_journal(parameters: CoreParameters, program: ReactiveProgram) -> OpenedJournal:
    """Take the journal of the parameters, and say what was found; raises JournalError."""
    run = _new_run()
    description = RunProgram.of(run, program, parameters.deciding).text()
    header = Header(run, program.fingerprint, _launch(), description)
    found = take_journal(_folder(parameters.journal, header.program), parameters.resume, header)
    if parameters.journal == AUTO:
        tidy(_shelf(), time.time())
    for remark in found.remarks:
        (rospy.logwarn if found.odd else rospy.loginfo)("%s: %s", rospy.get_name(), remark)
    return found


def take_journal(folder: Optional[Path], resume: str, fresh: Header, patience: float = TAKEN) -> OpenedJournal:
    """As :func:`open_journal`, but where another core uses the journal wait for its end.

    Of two nodes of the same name ROS ends the older one, which has it until then.
    """
    end = time.monotonic() + patience
    while True:
        try:
            return open_journal(folder, resume, fresh)
        except LockedError:
            if time.monotonic() >= end or rospy.is_shutdown():
                raise
            time.sleep(0.1)


def _folder(given: str, program: str) -> Optional[Path]:
    """The folder as given, or the usual one: of a core's name, its master and its program; None for none."""
    if given != AUTO:
        return None if given in ("", NONE) else Path(given).expanduser()
    words = f"{rospy.get_name()}-{rosgraph.get_master_uri().partition('://')[2]}-{program[:8]}"
    return _shelf() / re.sub(r"[^\w.-]+", "_", words.strip("/"))


def _shelf() -> Path:
    return Path(rospkg.get_ros_home()) / "rosoclingo"


def _launch() -> str:
    """What a node that its roslaunch starts again has in common with the one before alone; empty for one by hand."""
    by_roslaunch = any(word.startswith("__log:=") for word in sys.argv)
    return f"{rospy.get_param('/run_id', '')} {os.getppid()}" if by_roslaunch else ""


def _new_run() -> str:
    """An identity that no other run has, and that tells when it began (UTC)."""
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime()) + "-" + uuid.uuid4().hex[:8]
