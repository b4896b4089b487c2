"""oClingo's TCP service, and the command ``oclingo``."""
