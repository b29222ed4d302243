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

}  // namespace
}  // namespace scree
