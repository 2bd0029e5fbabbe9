"""Named values of an answer."""

from __future__ import annotations

from typing import Any


class Fields(dict[str, Any]):
    """Named values: ``fields.name`` and ``fields["name"]`` are the same."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            known = ", ".join(self)
            raise AttributeError(f"no {name!r}; there are {known}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(key for key in self if key.isidentifier())]
