// What about a fit of cutting coefficients should not be believed without a second look.
#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "models/slot_coefficients.hpp"

namespace stillcut {
namespace {

constexpr double kRare = 3.3;          // standard deviations: chance shows such a pattern once in a thousand fits
constexpr double kVisible = 0.01;      // of the largest force: less is of no consequence
constexpr double kClear = 2.0;         // standard errors
constexpr double kLargestRatio = 1.5;  // krc / ktc: sharp to blunt tools in metals lie at 0.2 to 1
constexpr double kNarrow = 30.0;       // condition: feeds that span some 7 % of their mean
constexpr double kLargestOutOfCut = 0.05;

enum SlotEntry { at_ktc, at_krc, at_kac, at_kte, at_kre, at_kae };

template <class... Values>
std::string line(const char* format, Values... values) {
  std::array<char, 320> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

bool clearly_negative(const SlotFit& fit, SlotEntry index) {
  return fit.value[index] < -kClear * fit.standard_error[index] && fit.value[index] < 0.0;
}

// Forces of the wrong sign are what a first evaluation gets wrong most: one line says which axis, or that all are.
void doubt_signs(const SlotFit& fit, std::vector<std::string>& lines) {
  const bool tangential = clearly_negative(fit, at_ktc), radial = clearly_negative(fit, at_krc);
  if (tangential && radial)
    lines.emplace_back(
        "ktc and krc are negative: are these the forces on the workpiece (a dynamometer under it)? Change the sign of "
        "all three");
  else if (tangential)
    lines.emplace_back("ktc is negative: fy has the wrong sign, or y is not z × feed (z away from the part)");
  else if (radial)
    lines.emplace_back("krc is negative: fx has the wrong sign, or x does not point along the feed");
  if (clearly_negative(fit, at_kte) || clearly_negative(fit, at_kre))
    lines.emplace_back(
        "an edge coefficient is negative: forces do not grow in proportion to the feed, or carry an offset (--zero)");
}

}  // namespace

std::vector<std::string> doubts(const SlotFit& fit, const Tool& tool, const std::vector<SlotTest>& tests) {
  std::vector<std::string> lines;
  doubt_signs(fit, lines);
  if (fit.value[at_ktc] > 0.0 && fit.value[at_krc] > kLargestRatio * fit.value[at_ktc])
    lines.push_back(line("krc is %.2g times ktc: are x and y exchanged?", fit.value[at_krc] / fit.value[at_ktc]));
  if (fit.value[at_ktc] < kClear * fit.standard_error[at_ktc] && !clearly_negative(fit, at_ktc))
    lines.emplace_back("ktc cannot be told from zero: the forces do not grow with the feed");
  if (std::all_of(tests.begin(), tests.end(), [](const SlotTest& test) { return test.mean_force.z() == 0.0; }))
    lines.emplace_back("fz is zero in all tests: kac and kae are zero because nothing was measured");
  if (fit.condition > kNarrow)
    lines.emplace_back("the feeds per tooth lie close to each other: spread them for smaller standard errors");
  constexpr std::array kAxes{"fx", "fy", "fz"};
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const auto& [feed, depth] = std::pair{fit.axes.at(axis).feed_squared, fit.axes.at(axis).depth_squared};
    if (feed.significance > kRare && feed.share > kVisible)
      lines.push_back(
          line("%s is no straight line over the feed per tooth (bent by %.1f %%): chatter, rubbing at the "
               "small feeds, or a size effect",
               kAxes.at(axis), 100.0 * feed.share));
    if (depth.significance > kRare && depth.share > kVisible)
      lines.push_back(
          line("%s does not follow the axial depth as the tool's shape says (by %.1f %%): was the depth zeroed on the "
               "surface, does runout or vibration keep teeth out?",
               kAxes.at(axis), 100.0 * depth.share));
  }
  double smallest = tests.front().feed_per_tooth;
  for (const SlotTest& test : tests) smallest = std::min(smallest, test.feed_per_tooth);
  if (const double out = arc_out_of_cut(tool, smallest); out > kLargestOutOfCut)
    lines.push_back(
        line("runout keeps teeth out of %.0f %% of the slot at %g mm a tooth: edge coefficients come out "
             "low; shear coefficients hold",
             100.0 * out, smallest * 1e3));
  return lines;
}

}  // namespace stillcut
