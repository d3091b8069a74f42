"""What the models are fitted with: bins, prior, babbling."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from bayeshunt.config.schema.groups import NonNegative, Positive, Settings

__all__ = ["ModelSettings"]


class ModelSettings(Settings):
    """Bins and prior of the models."""

    prior: NonNegative = Field(0.0, description="Dirichlet pseudo-count per cell; 0 is maximum likelihood")
    structure: Literal["naive", "tan", "joint", "previous_gait", "learned"] = Field(
        "naive", description="what depends on what: naive is the paper's"
    )
    backoff: Positive = Field(
        5.0, description="of structure previous_gait: rows that a gait's own table is worth after each gait"
    )
    distance_bin: Positive = Field(0.1, description="distance bin width [body lengths]")
    angle_bins: Annotated[int, Field(ge=1, le=3600)] = Field(36, description="bins of the full turn")
    heading_bins: Annotated[int, Field(ge=1, le=3600)] = Field(36, description="bins of the full turn")
    babbling_steps: Annotated[int, Field(ge=1, le=1_000_000_000)] = Field(2000, description="gaits babbled")
    exploring_steps: Annotated[int, Field(ge=1, le=1_000_000_000)] | None = Field(
        None,
        description="gaits babbled in an arena before hunts there, by planners that do; by default 3,328 s of them",
    )
