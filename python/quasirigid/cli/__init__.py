"""The command line `quasirigid`, of the extra `cli`. Lengths in mm, forces in N, pressures in kPa here."""

from .commands import run as run
