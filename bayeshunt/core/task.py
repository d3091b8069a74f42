"""What a hunter is asked to do: how near it must come to its prey, and how soon."""

from __future__ import annotations

from dataclasses import dataclass

from bayeshunt.core.checks import check_positive

__all__ = ["CATCH_BODIES", "Task"]

#: Distance between the centres that counts as a catch where nothing else is said, in body lengths (the paper's).
CATCH_BODIES = 1.02


@dataclass(frozen=True)
class Task:
    """A hunt's goal; what is not known is None.

    catch_distance: metres between the centres that count as a catch, > 0. time_limit: seconds until a hunt without
    a catch ends, > 0. Raises InputError for anything else.
    """

    catch_distance: float | None = None
    time_limit: float | None = None

    def __post_init__(self) -> None:
        for name, unit in (("catch_distance", "metres"), ("time_limit", "seconds")):
            if getattr(self, name) is not None:
                check_positive(getattr(self, name), name, unit)
