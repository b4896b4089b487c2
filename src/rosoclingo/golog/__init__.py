"""Translation of Golog control programs (``.golog``) into rules for ``encodings/golog.lp``; see doc/golog.md."""

from rosoclingo.golog.linking import read, translate, translate_files

__all__ = ["read", "translate", "translate_files"]
