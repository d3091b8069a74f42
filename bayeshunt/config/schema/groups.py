"""What every group of settings shares: frozen, no unknown keys, finite numbers within ranges."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bayeshunt.core import displays
from bayeshunt.core.errors import ConfigError

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _Model
else:
    _Model = type(BaseModel)

__all__ = ["Finite", "NonNegative", "Positive", "Settings", "Share", "ShownSettings"]

Positive = Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]
Finite = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]


class _Named(_Model):
    """Classes of settings whose constructors say in one line which value is wrong."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        try:
            return super().__call__(*args, **kwargs)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            place = ".".join(map(str, first["loc"]))
            message = " ".join(str(first["msg"]).removeprefix("Value error, ").split())
            raise ConfigError(f"{self.__name__}: {place + ': ' if place else ''}{message}") from None


class Settings(BaseModel, metaclass=_Named):
    """A frozen group of settings; unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class ShownSettings(displays.Displayed, Settings):
    """Settings that show themselves: as text, and in a notebook."""
