"""A database: durability, and reports of failed writes."""

import sqlite3
from contextlib import closing

import pytest

from rosoclingo.common.database import Database

TABLE = "CREATE TABLE IF NOT EXISTS word (text TEXT PRIMARY KEY)"


def add(text):
    return lambda db: db.execute("INSERT INTO word VALUES (?)", (text,)) and text


def words(db):
    return [text for (text,) in db.execute("SELECT text FROM word ORDER BY rowid")]


@pytest.fixture
def database(tmp_path):
    found = Database(tmp_path / "folder" / "words.db", [TABLE], 2.0)
    yield found
    found.close()


def test_database_is_synced_before_a_transaction_returns(database):
    """SQLite returns from a durable commit in its mode FULL, which is 2."""
    assert database.run(lambda db: db.execute("PRAGMA synchronous").fetchone()) == (2,)
    assert database.run(lambda db: db.in_transaction)
    assert database.run(add("a")) == "a"
    with closing(sqlite3.connect(f"{database.path.as_uri()}?mode=ro", uri=True)) as reader:
        assert words(reader) == ["a"]


def test_database_changes_nothing_if_a_transaction_fails(database):
    database.run(add("a"))
    assert database.run(lambda db: [add("b")(db), db.execute("nonsense")]) is None
    assert "syntax error" in database.fault
    assert database.run(words) == ["a"]
    assert database.fault == ""
