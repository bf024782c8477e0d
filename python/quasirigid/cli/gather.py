"""Options that several commands share, each written once."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable
from typing import Any, get_type_hints

__all__ = ["gathered"]


def gathered(command: Callable[..., int]) -> Callable[..., int]:
    """Return a command whose parameters that are dataclasses are spread into their fields.

    Parameters
    ----------
    command : callable
        Takes its parameters by keyword; the fields of a dataclass are options, annotated as such.
    """
    hints = get_type_hints(command, include_extras=True)
    groups: dict[str, type[Any]] = {}
    needed: list[inspect.Parameter] = []
    for name, parameter in inspect.signature(command).parameters.items():
        kind = hints[name]
        if not (isinstance(kind, type) and dataclasses.is_dataclass(kind)):
            needed.append(_option(name, kind, parameter.default))
            continue
        groups[name] = kind
        types = get_type_hints(kind, include_extras=True)
        needed += [_option(one.name, types[one.name], _default_of(one)) for one in dataclasses.fields(kind)]

    def spread(**given: Any) -> int:
        made = {
            name: kind(**{one.name: given.pop(one.name) for one in dataclasses.fields(kind)})
            for name, kind in groups.items()
        }
        return command(**made, **given)

    spread.__doc__, spread.__name__ = command.__doc__, command.__name__
    # What is read for the command line.
    spread.__signature__ = inspect.Signature(needed)  # type: ignore[attr-defined]
    spread.__annotations__ = {parameter.name: parameter.annotation for parameter in needed}
    return spread


def _option(name: str, annotation: Any, default: Any) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _default_of(field: dataclasses.Field[Any]) -> Any:
    return inspect.Parameter.empty if field.default is dataclasses.MISSING else field.default
