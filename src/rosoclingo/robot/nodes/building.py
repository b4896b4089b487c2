"""What the build does for the robot's stand-in: ``python3 -m rosoclingo.robot.nodes.building FOLDER...``.

It compiles navigation and simulation, and puts a copy into each folder. Without numba the build goes on, and says so.
"""

import importlib
import os
import shutil
import sys
from pathlib import Path
from typing import Sequence

from rosoclingo.common.starting import missing


def main(folders: Sequence[str]) -> int:
    """Compile all parts and put a copy into each folder; what goes wrong is told and costs time at a start only."""
    try:
        compiling = importlib.import_module("rosoclingo.robot.nodes.compiling")
        for part in compiling.PARTS:
            compiling.compile_once(part, _say)
        for folder in folders:
            _copy(compiling.FOLDER, folder)
    except ModuleNotFoundError as error:
        _say(f"navigation and simulation are not compiled: {missing(error.name or str(error))}")
    except (ImportError, OSError) as error:
        _say(f"not compiled now, but at the first start: {error}")
    return 0


def _copy(compiled: str, folder: str) -> None:
    target = Path(folder, os.path.basename(compiled))
    shutil.rmtree(str(target), ignore_errors=True)
    shutil.copytree(compiled, str(target))


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
