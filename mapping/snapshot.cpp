#include "mapping/snapshot.hpp"

#include <algorithm>

namespace scree::mapping {

std::size_t MapSnapshot::measured_cells() const {
  return static_cast<std::size_t>(std::count(state.begin(), state.end(), CellState::measured));
}

}  // namespace scree::mapping
