"""Cutting the rendered part of a frame into tiles.

Tiles are numbered by column and row of a grid that starts at the crop's top left corner; the last column and row are
clipped. The order of work is centre-out, so that the middle of the picture comes first. Pixel values do not depend on
the cut, because the engine's random numbers are keyed by pixel and sample index.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PixelRect:
    """Half-open rectangle in pixels of the full frame, origin top left."""

    x: int
    y: int
    width: int
    height: int

    @property
    def area(self) -> int:
        """Number of pixels."""
        return self.width * self.height

    def contains(self, other: "PixelRect") -> bool:
        """Whether `other` lies wholly inside this rectangle."""
        return (
            self.x <= other.x
            and self.y <= other.y
            and other.x + other.width <= self.x + self.width
            and other.y + other.height <= self.y + self.height
        )


@dataclass(frozen=True, slots=True)
class TileGrid:
    """The tiles of one job: `crop` cut into squares of `tile_size` pixels, clipped at its right and lower edges."""

    crop: PixelRect
    tile_size: int

    @property
    def columns(self) -> int:
        """Number of tiles side by side."""
        return -(-self.crop.width // self.tile_size)

    @property
    def rows(self) -> int:
        """Number of tiles below each other."""
        return -(-self.crop.height // self.tile_size)

    @property
    def count(self) -> int:
        """Number of tiles; tile indices are 0 <= index < count, row by row."""
        return self.columns * self.rows

    def index(self, column: int, row: int) -> int | None:
        """Index of the tile at `column`, `row`, or None outside the grid."""
        if 0 <= column < self.columns and 0 <= row < self.rows:
            return row * self.columns + column
        return None

    def rect(self, index: int) -> PixelRect:
        """Pixels of the tile `index`, in the full frame."""
        row, column = divmod(index, self.columns)
        left, top = column * self.tile_size, row * self.tile_size
        return PixelRect(
            self.crop.x + left,
            self.crop.y + top,
            min(self.tile_size, self.crop.width - left),
            min(self.tile_size, self.crop.height - top),
        )

    def order(self) -> list[int]:
        """All tile indices, nearest to the middle first; equal distances row by row."""
        middle_column, middle_row = (self.columns - 1) / 2, (self.rows - 1) / 2

        def distance_squared(index: int) -> float:
            row, column = divmod(index, self.columns)
            return (column - middle_column) ** 2 + (row - middle_row) ** 2

        return sorted(range(self.count), key=lambda index: (distance_squared(index), index))
