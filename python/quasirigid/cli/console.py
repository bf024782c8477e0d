"""What the command line prints: results on stdout; progress, warnings and refusals on stderr."""

from __future__ import annotations

import io
import json
import os
import re
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, cast

import typer
from rich.console import Console

from .._units import MM
from ..contact.caps import WITHOUT_CAPS

__all__ = [
    "ContactTalk",
    "Talk",
    "print_all_letters",
    "progress",
    "refuse",
    "say",
    "show_warning",
    "speak_for",
]


@dataclass(frozen=True, kw_only=True)
class Talk:
    """How much is said, and in which form."""

    json: Annotated[
        bool, typer.Option("--json", help="Print the results as JSON, in SI with their units.")
    ] = False
    quiet: Annotated[
        bool,
        typer.Option(
            "--quiet",
            "-q",
            help="Leave out progress and warnings, which go to stderr. Results, their files and errors stay.",
        ),
    ] = False

    def __post_init__(self) -> None:
        """Hold back progress and warnings from now on, or let them through."""
        global _is_quiet
        _is_quiet = self.quiet

    @property
    def progress(self) -> bool:
        """Whether to report progress."""
        return not self.quiet

    def tell(self, text: str, record: Mapping[str, Any]) -> None:
        """Print results as text, or as JSON where that was asked for."""
        say(json.dumps(record, indent=2, allow_nan=False) if self.json else _in_options(text))

    def save_and_tell(
        self, text: str, record: Mapping[str, Any], out: Path | None, save: Callable[[Path], Sequence[Path]]
    ) -> None:
        """Write results where a folder is given, and print them, also where it takes no files."""
        try:
            if out is not None:
                with progress(f"writing {out}"):
                    text += "\nwrote " + ", ".join(map(str, save(out)))
        finally:
            self.tell(text, record)


@dataclass(frozen=True, kw_only=True)
class ContactTalk(Talk):
    """How much is said of contacts."""

    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Say why each thing was left out.")] = False


_is_quiet = False


@contextmanager
def progress(what: str) -> Iterator[None]:
    """Report on stderr what is going on, once it takes more than a second."""
    if _is_quiet:
        yield
        return
    terminal = Console(stderr=True)
    if terminal.is_terminal:
        with terminal.status(f"{what} ..."):
            yield
        return
    timer = threading.Timer(1.0, lambda: print(f"{what} ...", file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def print_all_letters() -> None:
    """Print "?" in place of a letter that the terminal's encoding lacks, as of mm² in that of Japan."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def say(text: str) -> None:
    """Print results on stdout; whoever has read enough may close it.

    Raises
    ------
    OSError
        If they cannot be printed, as on a full disk or where stdout was closed from the start.
    """
    if sys.stdout is None:
        raise OSError("standard output is closed, so no results are printed: leave it open")
    try:
        print(text, flush=True)
    except BrokenPipeError:
        close_stdout()
    except OSError as error:
        raise OSError(f"standard output cannot be written to: {error.strerror}") from None


def close_stdout() -> None:
    """Send what is still to come nowhere, so that the interpreter's last flush meets no closed pipe."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


# What a message tells to do stands in backticks: `name`, `name=value` or `Class(name=value)`.
_ADVICE = re.compile(r"`([^`=]+)(?:=([^`]*))?`( mm\b)?")
# Lengths and points of a message, and two with one unit: "0.005 to 1 m", "(0.1, 0, 0) m", "`name=8e-6` m".
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_LENGTH = rf"(?:{_NUMBER.pattern}|\({_NUMBER.pattern}(?:, {_NUMBER.pattern})*\))"
_IN_METRES = re.compile(rf"(?<![\w.])((?:{_LENGTH} to )?{_LENGTH}`?) m(?![\w^])")
# What options do for advice that does not have their name.
_BY_OPTIONS = {
    "response": ("coarse_edge_length", "--response body:coarse_edge_length"),
    "skin_mask": (WITHOUT_CAPS, "--skin-mask caps"),
    "product_unit": ("read_obstacle(unit", "--product-unit"),
}
# What the command at work has for them: its options, and the commands, which keep their names.
_words: dict[str, str] = {}


def speak_for(program: typer.Context) -> None:
    """Name arguments of the library from now on by the options of the command that was called."""
    commands = cast(Any, program.command).commands
    called = commands.get(program.invoked_subcommand)
    names = {one.name: one.opts[0] for one in called.params} if called else {}
    _words.clear()
    _words.update({name: f"`{name}`" for name in commands})
    _words.update({name: option for name, option in names.items() if option.startswith("--")})
    _words.update(told for option, told in _BY_OPTIONS.items() if option in names)
    _words["weld_tolerance"] = "--weld-tolerance"  # of `repair`, which others advise
    _words["read_hand"] = "`quasirigid hand FILE --out FOLDER`, which writes posed.ply,"


def _in_options(message: str) -> str:
    """Return a message of the library in mm, its arguments as options; others are told to be Python's."""
    return _ADVICE.sub(_as_option, _IN_METRES.sub(lambda found: f"{_in_mm(found[1])} mm", message))


def _in_mm(metres: str) -> str:
    return _NUMBER.sub(lambda number: f"{float(number[0]) * MM:.12g}", metres)


def _as_option(advice: re.Match[str]) -> str:
    name, value, unit = advice.groups(default="")
    argument = name.rpartition("(")[2]
    option = _words.get(name) or _words.get(argument)
    if option is None:
        return f"{advice[0]} of Python" if argument.isidentifier() else advice[0]
    value = value.strip('")').replace("None", "none") + unit.strip()
    return option + (f"{'=' if ':' in option else ' '}{value}" if value else "")


def show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning as one line on stderr."""
    if not _is_quiet:
        print(f"warning: {_in_options(str(message))}", file=sys.stderr)


def refuse(message: str, *, status: int = 2) -> int:
    """Print on one line of stderr what is wrong; return the exit status."""
    print("error: " + _in_options(" ".join(message.split())), file=sys.stderr)
    return status
