#pragma once
// The routes behind structure_function(); their arguments have been checked.

#include "fractal/structure_function.hpp"

namespace scree::fractal {

StructureFunction reference_pairs(const PointColumns& points, const Annuli& annuli, Executor& executor);
StructureFunction all_pairs(const PointColumns& points, const Annuli& annuli, Executor& executor);
StructureFunction near_pairs(const PointColumns& points, const Annuli& annuli, Executor& executor);
StructureFunction thinned_pairs(const PointColumns& points, const Annuli& annuli, const PairOptions& options,
                                double spacing_m, Executor& executor);
Result<StructureFunction> lattice_pairs(const PointColumns& points, const Annuli& annuli, double cell_m,
                                        Executor& executor);

/// Errors: usage, as structure_function().
Status check_annuli(const Annuli& annuli);

/// Adds sums annulus by annulus.
void add_sums(std::vector<PairSums>& total, const std::vector<PairSums>& part);

}  // namespace scree::fractal
