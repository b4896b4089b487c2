"""Reactive logic programs: sources, directives, program parts, signatures and checks."""
