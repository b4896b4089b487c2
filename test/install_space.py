#!/usr/bin/env python3
"""Checks the install space from within: ``./dev exec-install test/install_space.py``.

All modules, executables and data files exist, and a scenario runs without the source tree. The build leaves the
workspace alone.
"""

import importlib
import os
import pkgutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
SCENARIO = "cancel_after_delivery"  # the one with the shortest drives
DATA_FOLDERS = ("config", "doc", "encodings", "launch", "templates", "web", "worlds", "msg", "action")


def installed_share() -> Path:
    """Return the package's folder as ROS finds it, which has to be the installed one."""
    found = subprocess.run(["rospack", "find", "rosoclingo"], check=True, capture_output=True, text=True)
    share = Path(found.stdout.strip())
    assert (share.parent.parent / ".catkin").exists(), f"not installed: {share}"
    return share


def check_modules(prefix: Path) -> int:
    """Import every module from the install space."""
    package = importlib.import_module("rosoclingo")
    names = [info.name for info in pkgutil.walk_packages(package.__path__, "rosoclingo.")]
    for name in names:
        module = importlib.import_module(name)
        assert prefix in Path(str(module.__file__)).parents, f"{name} comes from {module.__file__}"
    return len(names)


def check_files(share: Path, executables: Path) -> int:
    """Compare the installed files with the source tree."""
    wanted = [executables / path.name for path in (SOURCE / "scripts").glob("*") if path.is_file()]
    for folder in DATA_FOLDERS:
        files = [path for path in (SOURCE / folder).rglob("*") if path.is_file() and "__pycache__" not in path.parts]
        wanted += [share / path.relative_to(SOURCE) for path in files]
    missing = [str(path) for path in wanted if not path.exists()]
    assert not missing, f"not installed: {', '.join(missing)}"
    return len(wanted)


def check_messages(workspace: Path) -> None:
    """Check that this build has not rewritten the workspace's messages, which starting nodes can be importing."""
    begun = (workspace / "build-install" / "begun").stat().st_mtime
    messages = list((workspace / "devel" / "lib").rglob("msg/_*.py"))
    later = [path.name for path in messages if path.stat().st_mtime > begun]
    assert messages, f"no messages in {workspace}"
    assert not later, f"written again by the build of the install space: {', '.join(later)}"


def check_compiled() -> int:
    """Check that a node without a cache uses the installed compiled code, and reports no compilation."""
    code = "from rosoclingo.robot.nodes import compiling as c; [c.compile_once(part, print) for part in c.PARTS]"
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", code]
        environment = {**os.environ, "NUMBA_CACHE_DIR": folder}
        said = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
        assert not said, said
        twice = sorted(path.name for path in Path(folder).rglob("*.2.nbc"))
        assert not twice, f"compiled for several kinds of arguments: {', '.join(twice)}"
        return sum(path.suffix == ".nbc" for path in Path(folder).rglob("*"))


def main() -> None:
    """Run the checks; an assertion names the fault."""
    share = installed_share()
    prefix = share.parent.parent
    print(f"install space {prefix}")
    print(f"{check_modules(prefix)} modules imported")
    print(f"{check_files(share, prefix / 'lib' / 'rosoclingo')} files found", flush=True)
    check_messages(prefix.parent)
    print(f"{check_compiled()} functions compiled already", flush=True)
    sys.exit(subprocess.run(["rosrun", "rosoclingo", "demo", SCENARIO], cwd="/", check=False).returncode)


if __name__ == "__main__":
    main()
