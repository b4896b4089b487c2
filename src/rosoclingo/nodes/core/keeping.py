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

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.journal import Header
from rosoclingo.reasoning.resuming import Found, open_journal


def find_journal(parameters: CoreParameters, program: ReactiveProgram) -> Found:
    """Take the journal of the parameters, and say what was found; raises JournalError."""
    header = Header(_new_run(), program.fingerprint, _launch())
    found = open_journal(_folder(parameters.journal, header.program), parameters.resume, header)
    for remark in found.remarks:
        (rospy.logwarn if found.odd else rospy.loginfo)("%s: %s", rospy.get_name(), remark)
    return found


#: In place of a folder: the usual one.
AUTO = "auto"


def _folder(given: str, program: str) -> Optional[Path]:
    """The folder as given, or the usual one: of a core's name, its master and its program; None for none."""
    if given != AUTO:
        return Path(given).expanduser() if given else None
    words = f"{rospy.get_name()}-{rosgraph.get_master_uri().partition('://')[2]}-{program[:8]}"
    return Path(rospkg.get_ros_home()) / "rosoclingo" / re.sub(r"[^\w.-]+", "_", words.strip("/"))


def _launch() -> str:
    """What a node that its roslaunch starts again has in common with the one before alone; empty for one by hand."""
    by_roslaunch = any(word.startswith("__log:=") for word in sys.argv)
    return f"{rospy.get_param('/run_id', '')} {os.getppid()}" if by_roslaunch else ""


def _new_run() -> str:
    """An identity that no other run has, and that tells when it began (UTC)."""
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime()) + "-" + uuid.uuid4().hex[:8]
