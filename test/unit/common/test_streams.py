"""Output on a full disk: messages get lost, and nothing else fails."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from full_disk import room_for

from rosoclingo.common.streams import LenientStream

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
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
def test_streams_rospy_log_survives_a_full_disk():
    with open("/dev/full", "w") as full:
        assert subprocess.run([sys.executable, "-c", SPEAKER], stdout=full, stderr=full, timeout=60).returncode == 0


def test_streams_resume_once_the_disk_has_room(tmp_path):
    path = Path(tmp_path, "log")
    with open(path, "w") as file:
        stream = LenientStream(file)
        assert stream.write("first\n") == 6
        stream.flush()
        with room_for(6):
            stream.write("second\n")
            stream.flush()
        stream.write("third\n")
        stream.flush()
        assert stream.fileno() == file.fileno(), "all else is as it was"
    assert path.read_text().startswith("first\n")
    assert path.read_text().endswith("third\n")


PROGRAM = """#program base.
room("Küche"). % größer
#program cumulative(t).
lit(R,t) :- room(R), not out("Küche",t).
#show lit/2.
#program volatile(t).
"""
FILES = {
    "küche.lp": PROGRAM,
    "küche.golog": 'proc control { go("Küche"); }\n',
    "küche3.lp": '#base.\nroom("Küche").\n#hide.\n',
    "one.str": "#step 1.\n#endstep.\n",
    "küche.yaml": '"Ä": [1, 2]\n',
    "größe.yaml": "größe: 1\n",
}
PLAIN = {"LANG": "C", "LC_ALL": "C"}
LOCALES = [PLAIN, {**PLAIN, "PYTHONIOENCODING": "ascii"}, {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}]
KITCHEN, SIZE = r"[Kk](ü|\?\??|\\xfc)che", r"gr(öß|\?\?|\\xf6\\xdf)e"


def run(folder, environment, *command, given=None):
    """Run a script in a folder; return its output and its errors."""
    done = subprocess.run(
        [sys.executable, str(SCRIPTS / command[0]), *command[1:]],
        cwd=folder,
        env={**os.environ, "ROS_MASTER_URI": "http://localhost:1", **environment},
        input=given,
        capture_output=True,
        check=False,
        timeout=120,
    )
    return done.stdout.decode(), done.stderr.decode()


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


#: A command, and its output.
COMMANDS = [
    (("check", "küche.lp"), KITCHEN),
    (("check", "küche.lp", "--labels", "küche.yaml", "--interfaces", "größe.yaml"), SIZE),
    (("oclingo", "küche.lp", "--shortest", "--bound", "3", "--stream", "one.str"), KITCHEN),
    (("places", "Küche.yaml", "küche.yaml"), KITCHEN),
    (("new", "Küche"), KITCHEN),
    (("stage_world", "Küche.yaml", "-o", "x.world"), KITCHEN),
    (("journal", "show", "Küche"), KITCHEN),
    (("replay", "Küche.bag"), KITCHEN),
    (("demo", "Küche"), KITCHEN),
    (("play_scenario", "größe.yaml"), SIZE),
    (("request", "--plain", 'go("Küche",1)'), "no ROS master"),
]


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "words", "environment"),
    [(*one, LOCALES[number % len(LOCALES)]) for number, one in enumerate(COMMANDS)],
    ids=[" ".join(command[:2]) for command, _ in COMMANDS],
)
def test_streams_commands_print_any_text_in_any_locale(folder, command, words, environment):
    output, errors = run(folder, environment, *command)
    assert "Traceback" not in errors, errors
    assert re.search(words, output + errors), (output, errors)
