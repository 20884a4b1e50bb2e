#include "models/cheapest_pairs.hpp"

#include <limits>

namespace stillcut {
namespace {

// Square: the pairs themselves, one partner of price `alone` for each row and each column, and those two for nothing.
std::vector<std::vector<double>> with_the_lonely(const std::vector<std::vector<double>>& cost, double alone) {
  const std::size_t rows = cost.size(), columns = cost.front().size();
  std::vector<std::vector<double>> square(rows + columns, std::vector<double>(rows + columns, 0.0));
  for (std::size_t i = 0; i < square.size(); ++i)
    for (std::size_t j = 0; j < square.size(); ++j)
      if (i < rows && j < columns)
        square[i][j] = cost[i][j];
      else if (i < rows || j < columns)
        square[i][j] = alone;
  return square;
}

}  // namespace

std::vector<int> cheapest_pairs(const std::vector<std::vector<double>>& cost, double alone) {
  if (cost.empty()) return {};
  const auto square = with_the_lonely(cost, alone);
  const std::size_t size = square.size(), none = size;
  // Row by row: the shortest way, by reduced costs, from the row over pairs already made to a free column.
  std::vector<double> row_price(size, 0.0), column_price(size + 1, 0.0);
  std::vector<std::size_t> row_of(size + 1, none);  // of each column; column `size` is where a way begins
  for (std::size_t row = 0; row < size; ++row) {
    std::vector<double> way(size, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(size, size);
    std::vector<bool> visited(size + 1, false);
    std::size_t column = size;
    row_of[column] = row;
    while (row_of[column] != none) {
      visited[column] = true;
      const std::size_t at = row_of[column];
      double shortest = std::numeric_limits<double>::infinity();
      std::size_t next = size;
      for (std::size_t j = 0; j < size; ++j) {
        if (visited[j]) continue;
        const double reduced = square[at][j] - row_price[at] - column_price[j];
        if (reduced < way[j]) way[j] = reduced, from[j] = column;
        if (way[j] < shortest) shortest = way[j], next = j;
      }
      for (std::size_t j = 0; j <= size; ++j) {
        if (visited[j])
          row_price[row_of[j]] += shortest, column_price[j] -= shortest;
        else
          way[j] -= shortest;
      }
      column = next;
    }
    for (std::size_t j = column; j != size; j = from[j]) row_of[j] = row_of[from[j]];
  }
  std::vector<int> pairs(cost.size(), -1);
  for (std::size_t j = 0; j < cost.front().size(); ++j)
    if (row_of[j] < cost.size()) pairs[row_of[j]] = static_cast<int>(j);
  return pairs;
}

}  // namespace stillcut
