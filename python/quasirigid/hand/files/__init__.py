"""Hands and poses from files, and to files."""
