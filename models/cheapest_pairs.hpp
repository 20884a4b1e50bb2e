// The assignment problem: who goes with whom so that the sum of costs is smallest, where being left alone has a price.
#pragma once

#include <vector>

namespace stillcut {

// For each row of `cost` its column, or -1 where the row is better left alone. Leaving a row or a column alone costs
// `alone`, so that a pair dearer than 2 `alone` is never made. All rows are of one length and costs are finite.
// Hungarian method by shortest augmenting paths (Kuhn 1955; Jonker and Volgenant 1987).
std::vector<int> cheapest_pairs(const std::vector<std::vector<double>>& cost, double alone);

}  // namespace stillcut
