"""What a plot shows: curves in panels. All values are above 0, as the axes are logarithmic."""

from dataclasses import dataclass, field

Point = tuple[float, float]
Band = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Curve:
    """A line through points. `name` appears in the legend, once for all panels; `dashes` is SVG's stroke-dasharray.

    `band` is shaded behind the line: x with the lowest and the highest y there. `diamonds` are hollow marks beside it.
    """

    points: list[Point]
    name: str = ""
    colour: str = "#06c"
    dashes: str = "none"
    width: float = 2.0
    dots: bool = True
    band: list[Band] = field(default_factory=list)
    diamonds: list[Point] = field(default_factory=list)

    def values(self) -> list[Point]:
        """All that has to fit between the axes."""
        ends = [(x, y) for x, *ys in self.band for y in ys]
        return [*self.points, *ends, *self.diamonds]


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes and the curves between them; `across` and `up` name the axes."""

    curves: list[Curve]
    across: str
    up: str
