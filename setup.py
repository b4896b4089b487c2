"""Called by catkin, for all of the package, and by pip, for what needs no ROS: the solver and its commands.

Name, version and the rest come from package.xml, versions of libraries from pyproject.toml.
"""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Dict

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


def described() -> Dict[str, Any]:
    """The arguments of setup() that package.xml and pyproject.toml tell, without ROS's parser for the former."""
    here = Path(__file__).resolve().parent
    package = ElementTree.parse(here / "package.xml").getroot()
    told = {tag: " ".join(package.findtext(tag, "").split()) for tag in ("name", "version", "description", "license")}
    return {**told, "install_requires": re.findall(r'"((?:clingo|lark)>[^"]*)"', (here / "pyproject.toml").read_text())}


try:
    from catkin_pkg.python_setup import generate_distutils_setup
except ImportError:  # pip builds in an environment of its own, in which there is no ROS
    setup(
        **described(),
        packages=find_packages("src", include=WITHOUT_ROS),
        package_dir={"": "src"},
        python_requires=">=3.8",
        entry_points={"console_scripts": COMMANDS},
    )
else:
    setup(**generate_distutils_setup(packages=find_packages("src"), package_dir={"": "src"}))
