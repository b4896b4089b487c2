"""Called by catkin, for all of the package, and by pip, for what needs no ROS: the solver and its commands.

Version, description and licence come from package.xml; pyproject.toml has the libraries.
"""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Dict

from setuptools import find_packages, setup

#: What pip installs, with all that it imports.
WITHOUT_ROS = [
    "rosoclingo",
    *(
        f"rosoclingo.{room}{below}"
        for room in ("oclingo", "planning", "golog", "reasoning", "checking")
        for below in ("", ".*")
    ),
    "rosoclingo.common",
]
COMMANDS = [
    "check = rosoclingo.checking.check_command:main",
    "oclingo = rosoclingo.checking.oclingo_command:main",
    "golog = rosoclingo.golog.golog_command:main",
    "gringo3to5 = rosoclingo.oclingo.gringo3.translate_command:main",
]


def described() -> Dict[str, str]:
    """The arguments of setup() that package.xml tells, without ROS's parser for it."""
    package = ElementTree.parse(Path(__file__).resolve().parent / "package.xml").getroot()
    return {tag: " ".join(package.findtext(tag, "").split()) for tag in ("version", "description", "license")}


try:
    from catkin_pkg.python_setup import generate_distutils_setup
except ImportError:  # pip builds in an environment of its own, in which there is no ROS
    setup(
        **described(),
        packages=find_packages("src", include=WITHOUT_ROS),
        package_dir={"": "src"},
        entry_points={"console_scripts": COMMANDS},
    )
else:
    setup(**generate_distutils_setup(packages=find_packages("src"), package_dir={"": "src"}))
