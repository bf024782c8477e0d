"""What the library tells is printed in mm, with the command's options for the arguments of Python."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("typer")
pytest.importorskip("rich")

import typer
from quasirigid.cli import run
from quasirigid.cli.commands import app
from quasirigid.cli.console import refuse, show_warning

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("command", "told", "printed"),
    [
        ("press", "refine it (`target_error`, `max_nodes`)", "refine it (--target-error, --max-nodes)"),
        (
            "demo",
            "refine it (`target_error`, `max_nodes`)",
            "refine it (--target-error, `max_nodes` of Python)",
        ),
        ("grasp", "`couple_fingers` joins them", "--couple-fingers joins them"),
        ("sweep", "fix fewer (`Body(fixed=)`)", "fix fewer (--fixed)"),
        ("grasp", "fix fewer (`Body(fixed=)`)", "fix fewer (`Body(fixed=)` of Python)"),
        ("press", "let it touch (`skin_mask=`)", "let it touch (--skin-mask)"),
        ("press", "a smaller `gap_tolerance` will", "a smaller `gap_tolerance` of Python will"),
        ("info", '`read_surface(unit="mm")` converts a file', "--unit mm converts a file"),
        ("info", '`read_obstacle(unit="mm")` converts a file', "--unit mm converts a file"),
        ("press", '`read_obstacle(unit="mm")` converts a file', "--product-unit mm converts a file"),
        ("hand", "give `rig`", "give --rig"),
        ("info", "see `repair`", "see `repair`"),
        (
            "info",
            "call `repair` with `weld_tolerance=8.3e-6` m",
            "call `repair` with --weld-tolerance 0.0083mm",
        ),
        (
            "press",
            "(`repair` with a `weld_tolerance` if they meet)",
            "(`repair` with a --weld-tolerance if they meet)",
        ),
        (
            "press",
            "mask it out, as by `surface.with_skin_mask(qr.skin_without_caps(surface))`",
            "mask it out, as by --skin-mask caps",
        ),
        (
            "press",
            "prepare it with `coarse_edge_length=6.84e-4` m",
            "prepare it with --response body:coarse_edge_length=0.684mm",
        ),
        ("press", 'a coarser mesh, or `method="auto"`', 'a coarser mesh, or `method="auto"` of Python'),
        ("press", "with `target_error=None` it is taken", "with --target-error none it is taken"),
        ("press", 'use `start="infinity"`', "use --start infinity"),
        # What this command calls so looks for more crossings, not for fewer.
        (
            "info",
            "leave it out (`check_crossings=False`)",
            "leave it out (`check_crossings=False` of Python)",
        ),
    ],
)
def test_an_argument_of_the_library_is_told_as_an_option_or_as_pythons(
    command: str, told: str, printed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([command, "--help"]) == 0
    capsys.readouterr()
    refuse(told)
    show_warning(told)
    assert capsys.readouterr().err == f"error: {printed}\nwarning: {printed}\n"


@pytest.mark.parametrize(
    ("told", "printed"),
    [
        ("pressed in by 1.2000e-3 m, more than 0.5 m", "pressed in by 1.2 mm, more than 500 mm"),
        ("outside 0.005 to 1 m: is it", "outside 5 to 1000 mm: is it"),
        ("near (0.0010, -2e-3, 0.030000) m;", "near (1, -2, 30) mm;"),
        ("from (0.1, 0, 0) to (0.2, 0, 0) m, where", "from (100, 0, 0) to (200, 0, 0) mm, where"),
        ("height 8e-4 m/N, width 5e-3 m", "height 0.8 mm/N, width 5 mm"),
        ("a moment of 2.5 N m, 3 m³, 4 m^2, 6", "a moment of 2.5 N m, 3 m³, 4 m^2, 6"),
    ],
)
def test_lengths_are_told_in_mm(told: str, printed: str, capsys: pytest.CaptureFixture[str]) -> None:
    show_warning(told)
    assert capsys.readouterr().err == f"warning: {printed}\n"


def words_in_rust(source: Path) -> Iterator[str]:
    code = re.sub(r"^\s*//.*$", "", source.read_text("utf-8").split("#[cfg(test)]")[0], flags=re.MULTILINE)
    for literal in re.findall(r'"((?:[^"\\]|\\.)*)"', code, flags=re.DOTALL):
        yield re.sub(r"\\\n\s*", "", literal).replace('\\"', '"')


def words_in_python(source: Path) -> Iterator[str]:
    tree = ast.parse(source.read_text("utf-8"))
    docstrings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    parts = [part for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values]
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
        elif isinstance(node, ast.Constant) and node not in docstrings and node not in parts:
            yield str(node.value)


def messages() -> list[str]:
    """Return the words of the library, those of the command line left out."""
    rust, python = ROOT.glob("src/**/*.rs"), ROOT.glob("python/quasirigid/**/*.py")
    texts = [words_in_rust(source) for source in sorted(rust)]
    texts += [words_in_python(source) for source in sorted(python) if "cli" not in source.parts]
    found = [word for text in texts for word in text if " " in word and not word.startswith("(")]
    assert len(found) > 500
    return found


def test_every_message_has_what_options_stand_for_in_backticks() -> None:
    commands = typer.main.get_group(app).commands.values()
    options = {one.name for command in commands for one in command.params} | {"coarse_edge_length"}
    for message in messages():
        # What is refused stands in front: the command line has checked it before.
        bare = re.sub(r"^\w+ (is|has) |`[^`]*`", "", message)
        told = re.findall(r"(\w+)( ?=(?!=))?", bare)
        # A word without an underscore may be English; before an equals sign it is an argument.
        assert not {word for word, equals in told if "_" in word or equals} & options, message


@pytest.mark.parametrize("command", ["press", "sweep", "grasp"])
def test_no_message_names_an_option_that_the_command_has_not(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([command, "--help"]) == 0
    options = set(re.findall(r"--[a-z][a-z-]+", capsys.readouterr().out))
    for message in messages():
        show_warning(message)
    told = capsys.readouterr().err
    assert set(re.findall(r"--[a-z][a-z-]+", told)) <= options | {"--weld-tolerance"}  # of `repair`
