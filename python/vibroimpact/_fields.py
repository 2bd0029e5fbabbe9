"""Named values of an answer."""

from __future__ import annotations

from typing import Any


class Fields(dict[str, Any]):
    """Named values: ``fields.name`` and ``fields["name"]`` are the same."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name not in self:
            raise AttributeError(f"no {name!r}; there are {', '.join(self)}")
        return self[name]

    def __missing__(self, name: str) -> Any:
        raise KeyError(f"no {name!r}; there are {', '.join(self)}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(key for key in self if key.isidentifier())]
