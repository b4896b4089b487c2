"""The stand-in for a robot: navigation, simulation and their nodes. A real robot replaces all of it."""
