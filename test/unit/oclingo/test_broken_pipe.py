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
    ("rosoclingo.checking.oclingo_command", "paper.lp --stream -"),
]


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("module", "words"), COMMANDS)
def test_command_ends_silently_if_its_reader_closes(module, words):
    reading, writing = os.pipe()
    os.close(reading)
    run = f"import sys; from {module} import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", run, *words.split()]
    update, pipe = "#step 1. #endstep.", subprocess.PIPE
    done = subprocess.run(command, input=update, stdout=writing, stderr=pipe, text=True, timeout=120, cwd=ENCODINGS)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "")
