"""Runs as bags: the recorder, the reader of bags, replay."""
