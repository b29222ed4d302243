#include "core/rolling_grid.hpp"

#include <gtest/gtest.h>
#include <map>
#include <utility>

#include "core/random.hpp"

namespace scree {
namespace {

// The same writes into a map that forgets what the window leaves: no stale cell survives a roll in any direction.
TEST(RollingGrid, EqualsAnUnboundedMapThatForgetsWhatLeft) {
  constexpr int kRows = 7, kColumns = 11;
  RollingGrid<int> grid(kRows, kColumns, -1);
  std::map<std::pair<int, int>, int> reference;
  CellIndex min{-3, 5};
  grid.roll_to(min);
  for (int step = 0; step < 300; ++step) {
    const auto words = random_words(1, 2, step, 0);
    const int reach = step % 10 == 0 ? 25 : 7;  // every tenth roll may leave the old window altogether
    min = {min.x + static_cast<int>(words[0] % reach) - reach / 2,
           min.y + static_cast<int>(words[1] % reach) - reach / 2};
    grid.roll_to(min);
    std::erase_if(reference, [&](const auto& entry) {
      return !grid.window().contains({entry.first.first, entry.first.second});
    });
    for (int i = 0; i < 20; ++i) {
      const auto place = random_words(3, 4, step, i);
      const CellIndex cell{min.x + static_cast<int>(place[0] % kColumns), min.y + static_cast<int>(place[1] % kRows)};
      grid.at(cell) = step;
      reference[{cell.x, cell.y}] = step;
    }
    for (int row = 0; row < kRows; ++row) {
      int column = 0;
      for (const auto piece : grid.row_pieces(row))
        for (const int value : piece) {
          const auto found = reference.find({min.x + column, min.y + row});
          ASSERT_EQ(value, found == reference.end() ? -1 : found->second) << "step " << step;
          ASSERT_EQ(value, grid(row, column));
          ++column;
        }
      ASSERT_EQ(column, kColumns);
    }
  }
}

// Relabelled and rolled in turns: what was written is found where the labels say.
TEST(RollingGrid, RelabelMovesTheContentsWithTheWindow) {
  RollingGrid<int> grid(6, 9, -1);
  grid.roll_to({-2, 3});
  std::map<std::pair<int, int>, int> reference;
  for (int step = 0; step < 200; ++step) {
    const auto words = random_words(5, 6, step, 0);
    const CellIndex by{static_cast<int>(words[0] % 3) - 1, static_cast<int>(words[1] % 3) - 1};
    grid.relabel(by);
    std::map<std::pair<int, int>, int> moved;
    for (const auto& [place, value] : reference) moved[{place.first + by.x, place.second + by.y}] = value;
    reference = moved;
    const CellIndex min{grid.window().min.x + static_cast<int>(words[2] % 5) - 2,
                        grid.window().min.y + static_cast<int>(words[3] % 5) - 2};
    grid.roll_to(min);
    std::erase_if(reference, [&](const auto& entry) {
      return !grid.window().contains({entry.first.first, entry.first.second});
    });
    const CellIndex cell{min.x + step % 9, min.y + step % 6};
    grid.at(cell) = step;
    reference[{cell.x, cell.y}] = step;
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 9; ++column) {
        const auto known = reference.find({min.x + column, min.y + row});
        ASSERT_EQ(grid(row, column), known == reference.end() ? -1 : known->second) << step;
      }
  }
}

}  // namespace
}  // namespace scree
