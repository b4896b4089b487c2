"""Create a catkin package for a new robot, from the files in ``templates/package``."""

import re
import shutil
from pathlib import Path
from typing import Iterable, Iterator, List

#: The placeholder for the package's name, in texts and file names of the templates.
_NAME = "@NAME@"

_FIT = re.compile(r"[a-z][a-z0-9_]{1,99}")


class NewPackageError(ValueError):
    """A package that cannot be created; the text has the reason and a solution."""


def new_package(name: str, folder: Path, templates: Path, known: Iterable[str] = ()) -> List[Path]:
    """Create the package ``name`` in a folder; return its files, relative to the folder.

    Raises NewPackageError if the name is invalid, belongs to one of the ``known`` packages or exists in the folder, if
    the folder is inside a package, or if the package cannot be written; then all its files are removed.
    """
    if not _FIT.fullmatch(name):
        raise NewPackageError(
            f"'{name}' is not a valid package name: use 2 to 100 lower-case letters, digits and '_', a letter first"
        )
    package = folder / name
    if any((above / "package.xml").exists() for above in package.resolve().parents):
        raise NewPackageError(
            f"{folder.resolve()} is inside a package, where ROS finds no other one: choose another --folder"
        )
    if name in known and not package.exists():
        raise NewPackageError(
            f"the package {name} already exists, and roslaunch could find either: choose another name"
        )
    try:
        package.mkdir()
    except FileExistsError:
        raise NewPackageError(f"{package} already exists: choose another name, or remove it") from None
    except OSError as error:
        raise NewPackageError(f"{package}: {error.strerror}: choose another --folder") from None
    try:
        return [path.relative_to(folder) for path in _write(name, package, templates)]
    except OSError as error:
        shutil.rmtree(package, ignore_errors=True)
        raise NewPackageError(f"{error.filename}: {error.strerror}") from None


def _write(name: str, package: Path, templates: Path) -> Iterator[Path]:
    for template in sorted(path for path in templates.rglob("*") if path.is_file()):
        if "__pycache__" not in template.parts:
            path = package / str(template.relative_to(templates)).replace(_NAME, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            text = template.read_text(encoding="utf-8").replace(_NAME, name)
            path.write_text(text, encoding="utf-8")
            if text.startswith("#!"):  # installed templates can have lost their permissions
                path.chmod(path.stat().st_mode | 0o111)
            yield path
