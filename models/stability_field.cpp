#include "models/stability_field.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

using Verdicts = std::vector<std::uint8_t>;

// The verdicts at one speed, solved where they are asked for.
class Column {
 public:
  Column(CutAtSpeed& cutting, std::span<const double> depths) : cutting_(cutting), depths_(depths) {
    known_.assign(depths.size(), kUnknown);
  }
  std::uint8_t at(std::size_t k) {
    if (known_[k] == kUnknown) known_[k] = cutting_.radius(depths_[k], kTolerance) < 1.0 ? 1 : 0;
    return known_[k];
  }
  [[nodiscard]] std::size_t size() const { return depths_.size(); }

  // The boundary between low and high, whose verdicts differ: the first depth of the upper one.
  std::size_t boundary(std::size_t low, std::size_t high) {
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (at(middle) == at(low) ? low : high) = middle;
    }
    return high;
  }

 private:
  static constexpr std::uint8_t kUnknown = 2;
  static constexpr double kTolerance = 1e-5;
  CutAtSpeed& cutting_;
  std::span<const double> depths_;
  Verdicts known_;
};

std::vector<std::size_t> boundaries(const Verdicts& verdicts) {
  std::vector<std::size_t> result;
  for (std::size_t k = 1; k < verdicts.size(); ++k) {
    if (verdicts[k] != verdicts[k - 1]) result.push_back(k);
  }
  return result;
}

void fill(Verdicts& verdicts, std::size_t from, std::size_t to, std::uint8_t verdict) {
  std::fill(verdicts.begin() + static_cast<std::ptrdiff_t>(from), verdicts.begin() + static_cast<std::ptrdiff_t>(to),
            verdict);
}

// Every `step`th depth, and the boundaries between those that differ.
Verdicts search(Column& column, std::size_t step) {
  Verdicts verdicts(column.size());
  for (std::size_t low = 0; low < column.size();) {
    const std::size_t high = std::min(low + step, column.size() - 1);
    const std::size_t change = high > low && column.at(high) != column.at(low) ? column.boundary(low, high) : high;
    fill(verdicts, low, change, column.at(low));
    fill(verdicts, change, high + 1, column.at(high));
    if (high == low) break;
    low = high;
    if (low + 1 == column.size()) break;
  }
  return verdicts;
}

// Where the boundary that was at `last` is now, between the boundaries beside it; 0 when it is not found.
std::size_t moved_boundary(Column& column, std::size_t last, std::size_t floor, std::size_t ceiling,
                           std::uint8_t below) {
  std::size_t low = last - 1, high = last;
  for (std::size_t stride = 1; column.at(low) != below; stride *= 2) {
    high = low;
    if (low <= floor) return 0;
    low = low >= floor + stride ? low - stride : floor;
  }
  for (std::size_t stride = 1; column.at(high) == below; stride *= 2) {
    low = high;
    if (high + 1 >= ceiling) return 0;
    high = std::min(high + stride, ceiling - 1);
  }
  return column.boundary(low, high);
}

// Follows the verdicts of the speed before; empty when a look contradicts them.
Verdicts follow(Column& column, const Verdicts& before, std::size_t turn) {
  const std::vector<std::size_t> last = boundaries(before);
  Verdicts verdicts(column.size(), before.front());
  std::size_t from = 0;
  std::uint8_t verdict = before.front();
  constexpr std::size_t kRun = 25;   // points between boundaries that one look is for
  constexpr std::size_t kLeap = 12;  // points: a boundary that moves farther may have met another
  constexpr double kGolden = 0.6180339887498949;
  for (std::size_t b = 0; b <= last.size(); ++b) {
    std::size_t to = column.size();
    if (b < last.size()) {
      const std::size_t ceiling = b + 1 < last.size() ? last[b + 1] : column.size();
      to = moved_boundary(column, last[b], from, ceiling, verdict);
      if (to == 0 || std::max(to, last[b]) - std::min(to, last[b]) > kLeap) return {};
    }
    const std::size_t looks = 1 + (to - from) / kRun;
    for (std::size_t look = 0; look < looks; ++look) {
      const double share = std::fmod(kGolden * static_cast<double>(turn), 1.0);
      const double place = (static_cast<double>(look) + share) / static_cast<double>(looks);
      const auto k = from + static_cast<std::size_t>(place * static_cast<double>(to - from));
      if (column.at(std::min(k, to - 1)) != verdict) return {};
    }
    if (b == last.size() && column.at(column.size() - 1) != verdict) return {};
    fill(verdicts, from, to, verdict);
    from = to, verdict = verdict == 1 ? 0 : 1;
  }
  return verdicts;
}

}  // namespace

std::vector<double> spectral_radii(const LinearCut& cut, std::span<const Mode> modes, std::span<const double> speeds,
                                   std::span<const double> depths, double tolerance) {
  std::vector<double> radii;
  if (speeds.empty()) return radii;
  radii.reserve(speeds.size() * depths.size());
  CutAtSpeed cutting(cut, modes, speeds.front(), 0);
  for (const double speed : speeds) {
    cutting.move_to(speed);
    for (const double depth : depths) radii.push_back(cutting.radius(depth, tolerance));
  }
  return radii;
}

std::vector<std::uint8_t> stable_cuts(const LinearCut& cut, std::span<const Mode> modes, std::span<const double> speeds,
                                      std::span<const double> depths) {
  if (speeds.empty() || depths.empty()) return {};
  CutAtSpeed cutting(cut, modes, speeds.front(), 0);
  std::vector<Verdicts> columns(speeds.size());
  constexpr std::size_t kSearchStep = 4;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    cutting.move_to(speeds[i]);
    Column column(cutting, depths);
    if (i > 0) columns[i] = follow(column, columns[i - 1], i);
    if (!columns[i].empty()) continue;
    columns[i] = search(column, i == 0 ? 1 : kSearchStep);
    for (std::size_t k = i; k-- > 0;) {  // back to where what came up began
      cutting.move_to(speeds[k]);
      Column again(cutting, depths);
      Verdicts anew = search(again, kSearchStep);
      const bool changed = anew != columns[k];
      columns[k] = std::move(anew);
      if (!changed) break;
    }
  }
  Verdicts all;
  all.reserve(speeds.size() * depths.size());
  for (const Verdicts& column : columns) all.insert(all.end(), column.begin(), column.end());
  return all;
}

}  // namespace stillcut
