"""What was reported of an experiment: the figures that its results are held against."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag, model_validator

from bayeshunt.config.schema.groups import Positive, Settings

__all__ = ["FORMS", "Published", "Reported"]

Count = Annotated[int, Field(ge=0, le=10_000_000)]
Portion = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


class Published(Settings):
    """What was reported of one planner in one arena; what was not is None."""

    success: Portion | None = Field(
        None, description="share of hunts caught, where counts are not known; a number instead of the group means it"
    )
    caught: Count | None = Field(None, description="hunts caught, from all bearings together")
    runs: Annotated[int, Field(ge=1, le=10_000_000)] | None = Field(None, description="of so many hunts")
    by_theta: tuple[Count, ...] | None = Field(
        None, description="hunts caught from each bearing of the protocol, of equally many hunts each"
    )
    printed: Portion | None = Field(None, description="the share as printed, where the counts give another one")
    mean_time: Positive | None = Field(None, description="mean catch time, a miss counted as the time limit [s]")

    @model_validator(mode="after")
    def _adds_up(self) -> Published:
        if (self.caught is None) != (self.runs is None):
            raise ValueError("caught and runs: give both or neither")
        if self.caught is not None and self.runs is not None:
            if self.caught > self.runs:
                raise ValueError(f"caught: {self.caught} are more than the {self.runs} runs")
            if self.success is not None:
                raise ValueError("success: the counts say it; what was printed instead goes into printed")
        if self.by_theta is not None:
            if self.caught is None or self.runs is None or sum(self.by_theta) != self.caught:
                raise ValueError(f"by_theta: {sum(self.by_theta)} caught in all, which caught does not say")
            each, left = divmod(self.runs, len(self.by_theta))
            if left or max(self.by_theta) > each:
                raise ValueError(f"by_theta: {len(self.by_theta)} bearings cannot share {self.runs} runs like this")
        return self

    @property
    def share(self) -> float | None:
        """The share caught: of the counts, or as reported without them."""
        if self.caught is None or self.runs is None:
            return self.success
        return self.caught / self.runs

    def at(self, number: int) -> Published | None:
        """Return what was reported of the bearing ``number`` of the protocol, from 0; None if nothing was."""
        if self.by_theta is None or self.runs is None:
            return None
        return Published(caught=self.by_theta[number], runs=self.runs // len(self.by_theta))


#: What tells the two ways apart in which a figure may be given; no keys of a settings file.
FORMS = ("<share>", "<figures>")


def _form(value: Any) -> str:
    return FORMS[isinstance(value, (dict, Published))]


#: A bare share, or all figures that there are.
Reported = Annotated[
    Annotated[float, Tag(FORMS[0])] | Annotated[Published, Tag(FORMS[1])],
    Discriminator(_form),
]
