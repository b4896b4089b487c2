"""Makes a catkin package for somebody's own robot, from the files in ``templates/package``."""

import re
import shutil
from pathlib import Path
from typing import Iterable, Iterator, List

#: What stands for the package's name, in the templates' texts and names.
_NAME = "@NAME@"

_FIT = re.compile(r"[a-z][a-z0-9_]{1,99}")


class NewPackageError(ValueError):
    """A package that cannot be made; the text says why, and what to do."""


def new_package(name: str, folder: Path, templates: Path, known: Iterable[str] = ()) -> List[Path]:
    """Make the package ``name`` in a folder; returns its files, relative to the folder.

    Raises NewPackageError where the name is not one for a package, or that of one of the ``known`` packages, something
    of that name is there, or the package cannot be written; then nothing of it stays.
    """
    if not _FIT.fullmatch(name):
        raise NewPackageError(
            f"'{name}' is no name for a package: lower-case letters, digits and '_', a letter first, 2 to 100 of them"
        )
    package = folder / name
    if name in known and not package.exists():
        raise NewPackageError(
            f"there is a package {name} already, and roslaunch would take either: choose another name"
        )
    try:
        package.mkdir()
    except FileExistsError:
        raise NewPackageError(f"{package} is there already: choose another name, or remove it") from None
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
            if text.startswith("#!"):  # what is installed may have lost its permissions
                path.chmod(path.stat().st_mode | 0o111)
            yield path
