"""A logarithmic axis with ticks at 1, 2 and 5 times the powers of ten."""

import math
from dataclasses import dataclass

STEPS = (1, 2, 5)
MOST_LABELS = 9


@dataclass(frozen=True, slots=True)
class LogScale:
    """Places the values from `low` to `high` between `start` and `end`, in pixels."""

    low: float
    high: float
    start: float
    end: float

    def place(self, value: float) -> float:
        """Where `value` lies."""
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self) -> list[float]:
        """The values to mark: powers of ten alone if those between them are too many."""
        all_ticks = _ticks(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)))
        inside = [tick for tick in all_ticks if self.low * 0.999 <= tick <= self.high * 1.001]
        if len(inside) <= MOST_LABELS:
            return inside
        return [tick for tick in inside if math.isclose(tick, 10.0 ** round(math.log10(tick)))]


def scale_of(values: list[float], start: float, end: float) -> LogScale:
    """The scale from the last tick below all `values` to the first one above them."""
    lowest, highest = min(values), max(values)
    ticks = _ticks(math.floor(math.log10(lowest)) - 1, math.ceil(math.log10(highest)) + 1)
    low = max(tick for tick in ticks if tick <= lowest)
    high = min(tick for tick in ticks if tick >= highest and tick > low)
    return LogScale(low, high, start, end)


def _ticks(first_power: int, last_power: int) -> list[float]:
    return [float(f"{step}e{power}") for power in range(first_power, last_power + 1) for step in STEPS]
