#!/usr/bin/env python3
"""Which rostests a Python can run that has ROS's modules only as far as these are Python.

As a command, told scripts, it says which of them ask for a ROS module that this Python lacks.
"""

import runpy
import subprocess
import sys
from pathlib import Path
from typing import List, Mapping, Sequence, Set

from processes import ROOT

DISTRIBUTION = Path("/usr/lib/python3/dist-packages")


def rostests_within(environment: Mapping[str, str], paths: Sequence[Path]) -> List[Path]:
    """The rostests whose nodes and test scripts all find their modules with the python3 of the environment."""
    scripts = {path: scripts_of(path) for path in paths}
    command = ["python3", __file__, *sorted({str(script) for some in scripts.values() for script in some})]
    done = subprocess.run(command, env=dict(environment), stdout=subprocess.PIPE, text=True, check=True)
    lacking = {Path(line) for line in done.stdout.splitlines()}
    return [path for path in paths if not scripts[path] & lacking]


def scripts_of(path: Path) -> Set[Path]:
    """The package's scripts that a rostest file runs: nodes, also those of files it includes, and tests."""
    from roslaunch.config import load_config_default  # not needed, nor there, where the scripts are tried

    config = load_config_default([str(path)], None, verbose=False, assign_machines=False)
    found = {ROOT / "scripts" / node.type for node in config.nodes if node.package == "rosoclingo"}
    found |= {path.parent / test.type for test in config.tests if test.package == "rosoclingo"}
    return {script for script in found if script.is_file()}


def lacks_a_module(script: Path) -> bool:
    """Whether a script ends for want of a module that the distribution has; any other fault is for its test to tell."""
    sys.path.insert(0, str(script.parent))
    try:
        runpy.run_path(str(script), run_name="importable")
    except (Exception, SystemExit) as error:  # noqa: BLE001 - a script may fail in any way
        absent = error.__context__ if isinstance(error, SystemExit) else error  # scripts tell it in words
        if isinstance(absent, ModuleNotFoundError):
            return (DISTRIBUTION / str(absent.name).split(".")[0]).exists()
        print(f"{script}: {error!r}", file=sys.stderr)
    finally:
        sys.path.pop(0)
    return False


if __name__ == "__main__":
    print(*(name for name in sys.argv[1:] if lacks_a_module(Path(name))), sep="\n")
