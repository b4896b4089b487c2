"""Golog: control programs (``.golog``) as facts and rules for ``encodings/golog.lp``; see doc/golog.md."""

from rosoclingo.languages.golog.writing import translate

__all__ = ["translate"]
