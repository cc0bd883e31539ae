"""Cutting a frame into tiles."""

from hypothesis import given
from hypothesis import strategies as st

from fluxfarm.domain.tiles import PixelRect, TileGrid

SIDES = st.integers(1, 150)
GRIDS = st.builds(TileGrid, st.builds(PixelRect, SIDES, SIDES, SIDES, SIDES), st.integers(8, 64))


@given(GRIDS)
def test_tiles_cover_the_crop_exactly_once(grid: TileGrid) -> None:
    covered: set[tuple[int, int]] = set()
    for index in range(grid.count):
        rect = grid.rect(index)
        assert grid.crop.contains(rect)
        pixels = {(x, y) for x in range(rect.x, rect.x + rect.width) for y in range(rect.y, rect.y + rect.height)}
        assert not covered & pixels
        covered |= pixels
    assert len(covered) == grid.crop.area


@given(GRIDS)
def test_order_names_each_tile_once_and_starts_in_the_middle(grid: TileGrid) -> None:
    order = grid.order()
    assert sorted(order) == list(range(grid.count))
    row, column = divmod(order[0], grid.columns)
    assert abs(column - (grid.columns - 1) / 2) <= 0.5
    assert abs(row - (grid.rows - 1) / 2) <= 0.5


@given(GRIDS)
def test_index_and_rect_agree(grid: TileGrid) -> None:
    for column, row in ((0, 0), (grid.columns - 1, grid.rows - 1)):
        index = grid.index(column, row)
        assert index is not None
        rect = grid.rect(index)
        assert (rect.x - grid.crop.x) // grid.tile_size == column
        assert (rect.y - grid.crop.y) // grid.tile_size == row
    assert grid.index(grid.columns, 0) is None
    assert grid.index(0, -1) is None
