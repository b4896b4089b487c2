"""World files of Stage with another speed. Stage keeps this speed only if it has a window."""

import os
import re
from pathlib import Path
from typing import List

from rosoclingo.robot.simulation.spec import WorldError

# Tokens: comments, strings, brackets, words and numbers, white space.
TOKENS = re.compile(r'#[^\n]*|"[^"\n]*"|[()\[\]]|[^\s"#()\[\]]+|\s+|.')
FILES = ("bitmap", "include", "texture")  # keywords before a file name, which is relative to the world file


def read_stage_world(path: str) -> str:
    """Return the text of a world file of Stage. Raises WorldError, which names the file."""
    try:
        return Path(path).read_text(encoding="utf-8", errors="surrogateescape")
    except OSError as error:
        raise WorldError(f"Stage's world {path} cannot be read: {error.strerror}") from error


def paced_world(text: str, folder: str, speed: float) -> str:
    """Return the text of a world file in ``folder`` with a given speed (simulated s per s).

    File names become absolute, so that the text can be stored in any folder.
    """
    kept: List[str] = []
    depth, word, drops = 0, "", False
    for token in TOKENS.findall(text):
        if drops and not token.isspace():  # the old speed
            drops = False
            continue
        if token == "speedup" and depth == 0:
            drops = True
            continue
        depth += (token == "(") - (token == ")")
        if token.startswith('"') and word in FILES and len(token) > 2 and not token.startswith('"/'):
            token = f'"{os.path.join(os.path.abspath(folder), token[1:-1])}"'
        if not token.isspace():
            word = token
        kept.append(token)
    return "".join(kept).rstrip("\n") + f"\nspeedup {speed:g}\n"
