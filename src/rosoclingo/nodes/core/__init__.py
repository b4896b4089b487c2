"""The core node."""
