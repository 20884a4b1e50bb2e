// The best division of a machining area into rectangular patches, each cut in one feed direction, where a change of
// direction costs: the combination of directions over all locations that the feed-direction paper leaves to dynamic
// programming (its section 7). Exact over all divisions by straight cuts from edge to edge, cut again as often as
// wanted (guillotine cuts), and over all orders that finish one side of a cut before the other.
//
// With C columns, R rows and D directions there are O(C^2 R^2) rectangles and O(C + R) cuts of each, and each cut is a
// product of two D x D tables in which sums take the place of products and the smallest that of sums.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace stillcut {

// Columns and rows of a grid, the ends not included.
struct GridRectangle {
  int column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;
};

struct Patch {
  GridRectangle rectangle;
  int direction = 0;  // index
};

struct PatchPlan {
  std::vector<Patch> patches;  // in the order of machining
  double cost = 0.0;           // of patches and changes; infinite: no division is possible
};

struct PatchCosts {
  int columns = 0, rows = 0, directions = 0;
  // What a rectangle costs in a direction; infinite: not possible. Called once for each.
  std::function<double(const GridRectangle&, int direction)> patch;
  // From a patch in one direction to the next in another or the same, the same forth and back.
  std::function<double(int, int)> change;
};

// The cheapest plan; of those that are equally cheap (to 1e-10 a cut) one with the fewest cuts. Throws
// std::invalid_argument for an empty grid, more than 12 columns or rows, no direction or more than 90.
PatchPlan plan_patches(const PatchCosts& costs);

}  // namespace stillcut
