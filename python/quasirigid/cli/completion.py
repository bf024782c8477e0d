"""`quasirigid completion`: scripts by which a shell completes commands and options."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from .arguments import choice
from .console import say

__all__ = ["COMPLETION_EXAMPLE", "completion"]

COMPLETION_EXAMPLE = "quasirigid completion bash"

Commands = Mapping[str, tuple[str, Mapping[str, str]]]

_BASH = """\
_quasirigid() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" words=""
    if [ "$COMP_CWORD" -eq 1 ]; then
        words="{commands} --version --help"
    elif [ "${{word#-}}" != "$word" ]; then
        case "${{COMP_WORDS[1]}}" in
{cases}
        esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o bashdefault -o default -F _quasirigid quasirigid
"""


def completion(
    context: typer.Context,
    shell: Annotated[str, typer.Argument(metavar="SHELL", help="bash, zsh or fish.")],
) -> int:
    """Print what makes a shell complete commands, options and file names.

    For bash and zsh: eval "$(quasirigid completion bash)" in ~/.bashrc or ~/.zshrc; for fish:
    quasirigid completion fish > ~/.config/fish/completions/quasirigid.fish
    """
    choice(shell, ("bash", "zsh", "fish"), "SHELL")
    commands = _commands(context)
    say(_fish(commands) if shell == "fish" else _bash(commands, is_zsh=shell == "zsh"))
    return 0


def _commands(context: typer.Context) -> Commands:
    """Return each command with its help and its options with theirs."""
    program: Any = context.find_root().command
    found = {}
    for name, command in program.commands.items():
        options = {
            option: (parameter.help or "").split(".")[0].split(" [")[0]
            for parameter in command.params
            for option in (*parameter.opts, *parameter.secondary_opts)
            if option.startswith("--")
        }
        found[name] = (command.short_help or "", options | {"--help": "Show the help"})
    return found


def _bash(commands: Commands, *, is_zsh: bool) -> str:
    cases = "\n".join(
        f'            {name}) words="{" ".join(options)}" ;;' for name, (_, options) in commands.items()
    )
    start = "autoload -U +X bashcompinit && bashcompinit\n" if is_zsh else ""
    return start + _BASH.format(commands=" ".join(commands), cases=cases).rstrip("\n")


def _fish(commands: Commands) -> str:
    def line(condition: str, kind: str, word: str, text: str) -> str:
        words = text.replace("'", "")
        return f"complete -c quasirigid -n '{condition}' {kind} {word} -d '{words}'"

    lines = []
    for name, (text, options) in commands.items():
        lines.append(line("__fish_use_subcommand", "-f -a", name, text))
        lines += [
            line(f"__fish_seen_subcommand_from {name}", "-l", option.removeprefix("--"), help_text)
            for option, help_text in options.items()
        ]
    return "\n".join(lines)
