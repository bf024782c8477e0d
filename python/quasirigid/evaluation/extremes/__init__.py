"""Extreme cases: scaled answers on one mesh, and endings that are named."""
