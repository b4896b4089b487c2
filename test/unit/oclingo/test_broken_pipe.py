"""Commands end silently if the reader of their output closes the pipe, such as ``| head``."""

import os
import subprocess
import sys

import pytest
from shipped import ENCODINGS

COMMANDS = [
    ("rosoclingo.golog.golog_command", "golog/elevator.golog"),
    ("rosoclingo.oclingo.gringo3.translate_command", "paper.lp"),
    ("rosoclingo.checking.check_command", "paper.lp"),
]


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("module", "file"), COMMANDS)
def test_command_ends_silently_if_its_reader_closes(module, file):
    reading, writing = os.pipe()
    os.close(reading)
    run = f"import sys; from {module} import main; sys.exit(main(sys.argv[1:]))"
    words = [sys.executable, "-c", run, str(ENCODINGS / file)]
    done = subprocess.run(words, stdout=writing, stderr=subprocess.PIPE, text=True, timeout=120)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "")
