"""What every group of settings shares: frozen, no unknown keys, finite numbers within ranges."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from bayeshunt.core import displays

__all__ = ["Finite", "NonNegative", "Positive", "Settings", "Share", "ShownSettings"]

Positive = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]
Finite = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]


class Settings(BaseModel):
    """A frozen group of settings; unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class ShownSettings(Settings):
    """Settings that show themselves: as text, and in a notebook."""

    def __str__(self) -> str:
        return displays.to_text(self)

    def _repr_html_(self) -> str | None:
        return displays.to_html(self)
