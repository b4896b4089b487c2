"""Finds the folder of the core's journal, and the launch that it belongs to."""

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

#: Limit in seconds of wall time for another core to release the journal.
PATIENCE = 10.0


def find_journal(parameters: CoreParameters, program: ReactiveProgram) -> OpenedJournal:
    """Open the journal that the parameters name, and log the result; raises JournalError."""
    run = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime()) + "-" + uuid.uuid4().hex[:8]  # unique, from its start (UTC)
    description = RunProgram.of(run, program, parameters.deciding).text()
    header = Header(run, program.fingerprint, _launch(), description)
    found = take_journal(_folder(parameters.journal, header.program), parameters.resume, header)
    if parameters.journal == AUTO:
        tidy(_shelf(), time.time())
    for remark in found.remarks:
        (rospy.logwarn if found.odd else rospy.loginfo)("%s: %s", rospy.get_name(), remark)
    return found


def take_journal(folder: Optional[Path], resume: str, fresh: Header, patience: float = PATIENCE) -> OpenedJournal:
    """Call :func:`open_journal`; if another core has the journal open, wait for its end.

    Of two nodes with the same name, ROS ends the older, which has the journal until then.
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
    """Return the given folder, or the default folder for the core's name, its master and its program; None for none."""
    if given != AUTO:
        return None if given in ("", NONE) else Path(given).expanduser()
    words = f"{rospy.get_name()}-{rosgraph.get_master_uri().partition('://')[2]}-{program[:8]}"
    return _shelf() / re.sub(r"[^\w.-]+", "_", words.strip("/"))


def _shelf() -> Path:
    return Path(rospkg.get_ros_home()) / "rosoclingo"


def _launch() -> str:
    """Return an id that a node shares only with its respawned instances; empty without roslaunch."""
    by_roslaunch = any(word.startswith("__log:=") for word in sys.argv)
    return f"{rospy.get_param('/run_id', '')} {os.getppid()}" if by_roslaunch else ""
