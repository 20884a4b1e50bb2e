#include <algorithm>
#include <cmath>

#include "models/pattern_passes.hpp"
#include "models/pattern_spiral.hpp"

namespace stillcut {
namespace {

// A piece, and what its loops leave to be cut within it.
struct LoopLevel {
  PlanePiece piece;
  std::vector<std::size_t> children;  // indices
};

// Each offset is made of the piece itself, not of the offset before: roundings at corners would add up.
std::vector<LoopLevel> loop_levels(const PlanePiece& piece, double step_over) {
  std::vector<LoopLevel> levels{{piece, {}}};
  for (std::size_t first = 0, end = 1, step = 1; first < end; first = end, end = levels.size(), ++step)
    for (PlanePiece& inner : shrunk(std::span(&piece, 1), static_cast<double>(step) * step_over)) {
      const auto parent = std::find_if(levels.begin() + first, levels.begin() + end, [&](const LoopLevel& level) {
        return encloses(level.piece, inner.outer.front());
      });
      if (parent == levels.begin() + end) continue;
      parent->children.push_back(levels.size());
      levels.push_back({std::move(inner), {}});
    }
  return levels;
}

// Every point of a piece is within the step over of a loop, as what the next offset loses is. A step over larger than
// the tool's radius leaves the middle and the corners between loops: their edges become loops of their own.
void add_rests(std::vector<LoopLevel>& levels, double radius) {
  const std::size_t count = levels.size();
  for (std::size_t i = 0; i < count; ++i) {
    PlanePieces inner;
    for (const std::size_t child : levels[i].children) inner.push_back(levels[child].piece);
    for (PlanePiece& rest : subtracted(shrunk(std::span(&levels[i].piece, 1), radius), grown(inner, radius))) {
      levels[i].children.push_back(levels.size());
      levels.push_back({std::move(rest), {}});
    }
  }
}

// Contours of a level and those of the levels within it that follow one to one, walls inward.
std::vector<std::vector<Contour>> nested(const std::vector<LoopLevel>& levels, const std::vector<std::size_t>& chain) {
  std::vector<std::vector<Contour>> sequences;
  for (const Contour& contour : contours_of(levels[chain.front()].piece)) sequences.push_back({contour});
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const PlanePiece& piece = levels[chain[i]].piece;
    sequences.front().push_back(piece.outer);
    for (std::size_t k = 1; k < sequences.size(); ++k) {
      const Eigen::Vector2d& within = sequences[k].back().front();
      const auto hole = std::find_if(piece.holes.begin(), piece.holes.end(), [&](const Contour& wider) {
        return encloses(PlanePiece{wider, {}}, within);
      });
      if (hole != piece.holes.end()) sequences[k].push_back(*hole);
    }
  }
  return sequences;
}

// Of items that each have a contour, the one whose contour is nearest to a point.
template <typename Items, typename ContourOf>
auto nearest_item(Items& items, const Eigen::Vector2d& point, ContourOf contour_of) {
  const auto distance = [&](const auto& item) { return (nearest_on(contour_of(item), point).point - point).norm(); };
  return std::min_element(items.begin(), items.end(),
                          [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
}

class LoopWriter {
 public:
  LoopWriter(std::vector<LoopLevel> levels, bool spiral, const Eigen::Vector2d& start, const PatternSettings& settings)
      : levels_(std::move(levels)), spiral_(spiral), at_(start), settings_(settings) {}

  void write(std::size_t level) {
    std::vector<std::size_t> chain{level};
    while (spiral_ && levels_[chain.back()].children.size() == 1) {
      const std::size_t child = levels_[chain.back()].children.front();
      if (levels_[child].piece.holes.size() != levels_[level].piece.holes.size()) break;
      chain.push_back(child);
    }
    std::vector<Contour> lines = through(chain);
    at_ = lines.back().back();
    for (Contour& line : lines) passes.push_back({std::move(line), settings_.milling});

    std::vector<std::size_t> children = levels_[chain.back()].children;
    while (!children.empty()) {
      const auto next = nearest_item(
          children, at_, [&](std::size_t i) -> auto& { return levels_[i].piece.outer; });
      const std::size_t child = *next;
      children.erase(next);
      write(child);
    }
  }

  std::vector<PatternPass> passes;

 private:
  // The outer loops first, then those about islands, the nearest next. Contours have what is still to be cut on their
  // left; in down milling it is to be on the right.
  [[nodiscard]] std::vector<Contour> through(const std::vector<std::size_t>& chain) const {
    std::vector<std::vector<Contour>> sequences = nested(levels_, chain);
    std::vector<Contour> lines;
    auto next = sequences.begin();
    while (!sequences.empty()) {
      if (settings_.milling == Milling::down)
        for (Contour& loop : *next) std::reverse(loop.begin(), loop.end());
      const Eigen::Vector2d start = lines.empty() ? at_ : lines.back().back();
      for (Contour& line : blended(*next, start, levels_.front().piece, settings_.step_over))
        lines.push_back(std::move(line));
      sequences.erase(next);
      next = nearest_item(
          sequences, lines.back().back(), [](const auto& loops) -> auto& { return loops.front(); });
    }
    return lines;
  }

  std::vector<LoopLevel> levels_;
  bool spiral_;
  Eigen::Vector2d at_;
  PatternSettings settings_;
};

}  // namespace

std::vector<PatternPass> loop_passes(const PlanePiece& piece, bool spiral, const Eigen::Vector2d& start,
                                     const PatternSettings& settings) {
  std::vector<LoopLevel> levels = loop_levels(piece, settings.step_over);
  if (settings.step_over > settings.tool_radius) add_rests(levels, settings.tool_radius);
  LoopWriter writer(std::move(levels), spiral, start, settings);
  writer.write(0);
  return std::move(writer.passes);
}

}  // namespace stillcut
