#include "models/patch_plan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// table[first * D + last]: the least cost of a rectangle's plan that begins in one direction and ends in another.
using Table = std::vector<double>;

// So that of plans that cost the same the one with fewer cuts is found; taken off again in the end.
constexpr double kCutCost = 1e-10;

struct Best {
  Table least;        // of the rectangle
  Table then_change;  // least, and from its last direction a change to any other
};

class PatchSearch {
 public:
  explicit PatchSearch(const PatchCosts& costs) : costs_(costs), d_(static_cast<std::size_t>(costs.directions)) {
    change_.resize(d_ * d_);
    for (std::size_t a = 0; a < d_; ++a)
      for (std::size_t b = 0; b < d_; ++b)
        change_[a * d_ + b] = kCutCost + costs.change(static_cast<int>(a), static_cast<int>(b));
    best_.resize(pairs(costs.columns) * pairs(costs.rows));
    for (int width = 1; width <= costs.columns; ++width)
      for (int height = 1; height <= costs.rows; ++height)
        for (int column = 0; column + width <= costs.columns; ++column)
          for (int row = 0; row + height <= costs.rows; ++row) solve({column, column + width, row, row + height});
  }

  PatchPlan plan() const {
    const GridRectangle all{0, costs_.columns, 0, costs_.rows};
    const Table& least = best_[place(all)].least;
    const auto cheapest = static_cast<std::size_t>(std::min_element(least.begin(), least.end()) - least.begin());
    PatchPlan plan;
    plan.cost = least[cheapest];
    if (!std::isfinite(plan.cost)) return plan;
    trace(all, cheapest / d_, cheapest % d_, plan.patches);
    plan.cost -= kCutCost * static_cast<double>(plan.patches.size() - 1);
    return plan;
  }

 private:
  static std::size_t pairs(int lines) { return static_cast<std::size_t>(lines) * static_cast<std::size_t>(lines); }

  std::size_t place(const GridRectangle& r) const {
    const auto column = static_cast<std::size_t>(r.column_begin * costs_.columns + r.column_end - 1);
    const auto row = static_cast<std::size_t>(r.row_begin * costs_.rows + r.row_end - 1);
    return column * pairs(costs_.rows) + row;
  }

  template <class Visit>
  static void for_each_cut(const GridRectangle& r, Visit visit) {
    for (int cut = r.column_begin + 1; cut < r.column_end; ++cut)
      visit(GridRectangle{r.column_begin, cut, r.row_begin, r.row_end},
            GridRectangle{cut, r.column_end, r.row_begin, r.row_end});
    for (int cut = r.row_begin + 1; cut < r.row_end; ++cut)
      visit(GridRectangle{r.column_begin, r.column_end, r.row_begin, cut},
            GridRectangle{r.column_begin, r.column_end, cut, r.row_end});
  }

  // least(first, last) = min over what comes between of left(first, x) + right(x, last).
  void lower_by_product(const Table& left, const Table& right, Table& least) const {
    for (std::size_t first = 0; first < d_; ++first) {
      double* const row = &least[first * d_];
      for (std::size_t x = 0; x < d_; ++x) {
        const double before = left[first * d_ + x];
        if (!(before < kInfinity)) continue;
        const double* const after = &right[x * d_];
        for (std::size_t last = 0; last < d_; ++last) row[last] = std::min(row[last], before + after[last]);
      }
    }
  }

  void solve(const GridRectangle& rectangle) {
    Table least(d_ * d_, kInfinity);
    for (std::size_t a = 0; a < d_; ++a) least[a * d_ + a] = costs_.patch(rectangle, static_cast<int>(a));
    for_each_cut(rectangle, [&](const GridRectangle& one, const GridRectangle& other) {
      lower_by_product(best_[place(one)].then_change, best_[place(other)].least, least);
    });
    // The other side of a cut first is the same plan backwards.
    for (std::size_t a = 0; a < d_; ++a)
      for (std::size_t b = 0; b < a; ++b)
        least[a * d_ + b] = least[b * d_ + a] = std::min(least[a * d_ + b], least[b * d_ + a]);
    Table then_change(d_ * d_, kInfinity);
    lower_by_product(least, change_, then_change);
    best_[place(rectangle)] = {std::move(least), std::move(then_change)};
  }

  // Finds again how a cost came about. What differs by rounding only counts as equal; one patch is looked at first.
  void trace(const GridRectangle& rectangle, std::size_t first, std::size_t last, std::vector<Patch>& patches) const {
    const double cost = best_[place(rectangle)].least[first * d_ + last];
    const double enough = cost + 1e-12 * std::max(1.0, std::abs(cost));
    if (first == last && costs_.patch(rectangle, static_cast<int>(first)) <= enough) {
      patches.push_back({rectangle, static_cast<int>(first)});
      return;
    }
    bool found = false;
    const auto try_order = [&](const GridRectangle& before, const GridRectangle& after) {
      const Table& left = best_[place(before)].least;
      const Table& right = best_[place(after)].least;
      for (std::size_t x = 0; x < d_ && !found; ++x) {
        for (std::size_t y = 0; y < d_ && !found; ++y) {
          if (!(left[first * d_ + x] + change_[x * d_ + y] + right[y * d_ + last] <= enough)) continue;
          found = true;
          trace(before, first, x, patches);
          trace(after, y, last, patches);
        }
      }
    };
    for_each_cut(rectangle, [&](const GridRectangle& one, const GridRectangle& other) {
      if (!found) try_order(one, other);
      if (!found) try_order(other, one);
    });
  }

  const PatchCosts& costs_;
  std::size_t d_;
  Table change_;
  std::vector<Best> best_;
};

}  // namespace

PatchPlan plan_patches(const PatchCosts& costs) {
  constexpr int kMostLines = 12, kMostDirections = 90;
  if (costs.columns < 1 || costs.rows < 1 || costs.columns > kMostLines || costs.rows > kMostLines)
    throw std::invalid_argument("plan of patches: 1 to 12 columns and rows");
  if (costs.directions < 1 || costs.directions > kMostDirections)
    throw std::invalid_argument("plan of patches: 1 to 90 directions");
  return PatchSearch(costs).plan();
}

}  // namespace stillcut
