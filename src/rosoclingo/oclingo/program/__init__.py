"""What is loaded: sources, directives, program parts, signatures, checks."""
