"""The table ``bisect`` of a scenario in a study: the bisected parameter, and the ends and tolerance of the search."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field, StrictFloat, StrictInt, model_validator

from scenarios.bisection import Bisection


class Bisect(BaseModel):
    """Search for the value of a parameter at which a stack begins to fall."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    parameter: str
    """Name of the bisected parameter, whose value is a number; ``parameters`` of the scenario must not contain this
    name."""
    low: StrictFloat | StrictInt
    """Lower end of the search. The search starts with trials at both ends."""
    high: StrictFloat | StrictInt
    """Upper end of the search."""
    tolerance: float = Field(gt=0)
    """Greatest width of the final bracket, in the unit of the parameter."""

    @property
    def bisection(self) -> Bisection:
        """Ends and tolerance of the search."""
        return Bisection(float(self.low), float(self.high), self.tolerance)

    @property
    def middle(self) -> float:
        """Middle of the range of the search."""
        return (self.low + self.high) / 2

    @model_validator(mode="after")
    def _ends_are_apart(self) -> Bisect:
        if self.high - self.low < 2 * self.tolerance:
            raise ValueError(
                f"'high' must exceed 'low' by two tolerances or more, got {self.low} to {self.high} with tolerance "
                f"{self.tolerance}: widen the range or reduce 'tolerance'"
            )
        return self
