"""Error against run time on problems with known answers."""
