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


# An argument of the library in a message, as `unit="mm"` or `Body(fixed=)`.
_ARGUMENT = re.compile(r"`(?:\w+\()?(\w+)(?:=[^`]*)?`")
# The one of `repair`, which other commands advise too, and that of a body, with their values (m).
_WELDING = re.compile(r"\bweld_tolerance\b(?: = ([\d.e+-]+) m\b)?")
_COARSE_EDGES = re.compile(r"\bcoarse_edge_length = ([\d.e+-]+) m\b")
# How Python leaves out flat cut faces.
_WITHOUT_CAPS = "`surface.with_skin_mask(qr.skin_without_caps(surface))`"
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
    _words["read_hand"] = "`quasirigid hand FILE --out FOLDER`, which writes posed.ply,"


def _in_options(message: str) -> str:
    """Return a message of the library with options for its arguments; others are told to be Python's."""
    if "skin_mask" in _words:
        message = message.replace(_WITHOUT_CAPS, "--skin-mask caps")
    if "product_unit" in _words and message.startswith("the product is "):
        message = message.replace("`unit=", "`product_unit=")
    told = _ARGUMENT.sub(lambda found: _words.get(found[1], f"{found[0]} of Python"), message)
    # No command leaves that check out, nor chooses how problems are solved.
    told = told.replace("check_crossings = false", "`check_crossings=False` of Python")
    told = re.sub(r"\bmethod auto\b", '`method="auto"` of Python', told)
    told = re.sub(r"\btilt_point\b", "--tilt-point", told)
    told = _COARSE_EDGES.sub(lambda found: f"--response body:coarse_edge_length={_in_mm(found[1])}", told)
    return _WELDING.sub(lambda found: "--weld-tolerance" + (f" {_in_mm(found[1])}" if found[1] else ""), told)


def _in_mm(metres: str) -> str:
    return f"{float(metres) * MM:.12g}mm"


def show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    """Print a warning as one line on stderr."""
    if not _is_quiet:
        print(f"warning: {_in_options(str(message))}", file=sys.stderr)


def refuse(message: str, *, status: int = 2) -> int:
    """Print on one line of stderr what is wrong; return the exit status."""
    print("error: " + _in_options(" ".join(message.split())), file=sys.stderr)
    return status
