"""Bounded verification: explores the core's runs of a program for all streams with few events."""
