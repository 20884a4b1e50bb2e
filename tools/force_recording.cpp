#include "tools/force_recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

constexpr double kLongestGap = 0.25;   // turns without a sample
constexpr double kCutting = 0.5;       // of the usual force in the cut: a turn below is entry, exit or air
constexpr double kLargestForce = 1e6;  // N: no machine tool's
constexpr int kFewestTurns = 5;        // of a full slot: fewer are no steady cut
constexpr double kRoundingTurns = 1e-6;
const std::array<std::string, 4> kForceColumns{"time_s", "fx_n", "fy_n", "fz_n"};

std::string seconds(const RecordedSpan& span) { return csv_number(span.from) + ":" + csv_number(span.to) + " s"; }

// The forces' running integral, so that the mean over any span costs two look-ups.
class ForceIntegral {
 public:
  explicit ForceIntegral(const ForceRecording& recording) : recording_(recording), sum_{Eigen::Vector3d::Zero()} {
    for (std::size_t i = 1; i < recording.time.size(); ++i)
      sum_.emplace_back(sum_.back() + 0.5 * (recording.time[i] - recording.time[i - 1]) *
                                          (recording.force[i] + recording.force[i - 1]));
  }
  [[nodiscard]] Eigen::Vector3d mean(const RecordedSpan& span) const {
    return (until(span.to) - until(span.from)) / (span.to - span.from);
  }

 private:
  [[nodiscard]] Eigen::Vector3d until(double time) const {
    const auto& times = recording_.time;
    const auto after = std::upper_bound(times.begin() + 1, times.end() - 1, time);
    const auto i = static_cast<std::size_t>(after - times.begin());
    const double since = time - times[i - 1], part = since / (times[i] - times[i - 1]);
    const Eigen::Vector3d here = recording_.force[i - 1] + part * (recording_.force[i] - recording_.force[i - 1]);
    return sum_[i - 1] + 0.5 * since * (recording_.force[i - 1] + here);
  }

  const ForceRecording& recording_;
  std::vector<Eigen::Vector3d> sum_;
};

void check_inside(const ForceRecording& recording, const RecordedSpan& span, const char* option) {
  if (span.from < recording.time.front() || span.to > recording.time.back())
    throw InputError(recording.file, 0,
                     std::string(option) + " " + seconds(span) + " lies outside the recording, " +
                         seconds({recording.time.front(), recording.time.back()}));
}

// What the instrument shows without a force: constant, or a line through two stretches of air.
class Offset {
 public:
  Offset(const ForceRecording& recording, const ForceIntegral& integral, const std::vector<RecordedSpan>& air) {
    for (const RecordedSpan& span : air) check_inside(recording, span, "--zero");
    if (air.empty()) return;
    at_ = 0.5 * (air.front().from + air.front().to);
    value_ = integral.mean(air.front());
    const double apart = 0.5 * (air.back().from + air.back().to) - at_;
    if (apart != 0.0) slope_ = (integral.mean(air.back()) - value_) / apart;
  }
  // The mean over a span, this taken off.
  [[nodiscard]] Eigen::Vector3d corrected(const ForceIntegral& integral, const RecordedSpan& span) const {
    return integral.mean(span) - value_ - (0.5 * (span.from + span.to) - at_) * slope_;
  }

 private:
  double at_ = 0.0;
  Eigen::Vector3d value_ = Eigen::Vector3d::Zero(), slope_ = Eigen::Vector3d::Zero();
};

// The longest run of turns in which the tool cuts.
RecordedSpan cutting_span(const ForceRecording& recording, const ForceIntegral& integral, const Offset& offset,
                          double turn_s, double turns_to_axis) {
  const double begin = recording.time.front();
  const auto turns = static_cast<int>(std::floor((recording.time.back() - begin) / turn_s + kRoundingTurns));
  std::vector<double> size;
  size.reserve(static_cast<std::size_t>(turns));
  for (int k = 0; k < turns; ++k)
    size.push_back(offset.corrected(integral, {begin + k * turn_s, begin + (k + 1) * turn_s}).norm());
  if (size.empty()) throw InputError(recording.file, 0, "is shorter than a turn of the spindle; record more turns");
  const double highest = *std::max_element(size.begin(), size.end());
  std::vector<double> high;
  std::copy_if(size.begin(), size.end(), std::back_inserter(high), [&](double s) { return s >= kCutting * highest; });
  std::nth_element(high.begin(), high.begin() + static_cast<std::ptrdiff_t>(high.size() / 2), high.end());
  const double usual = high[high.size() / 2];
  if (!(usual > 0.0)) throw InputError(recording.file, 0, "holds no force: no cut is in it");
  int first = 0, count = 0;
  for (int k = 0, run = 0; k < turns; ++k) {
    run = size[static_cast<std::size_t>(k)] > kCutting * usual ? run + 1 : 0;
    if (run > count) {
      count = run;
      first = k + 1 - run;
    }
  }
  const int full_slot = static_cast<int>(std::ceil(turns_to_axis)) + 1;
  const int skipped = first > 0 ? full_slot : 1, left_out = first + count < turns ? full_slot : 0;
  if (count - skipped - left_out < kFewestTurns)
    throw InputError(recording.file, 0,
                     "the cut lasts " + std::to_string(count) + " turns, entry and exit take " +
                         std::to_string(skipped + left_out) + " of them; at least " + std::to_string(kFewestTurns) +
                         " must be left: record a longer slot, or give --cut FROM:TO");
  return {begin + (first + skipped) * turn_s, begin + (first + count - left_out) * turn_s};
}

void check_samples(const ForceRecording& recording, const RecordedSpan& span, double turn_s) {
  for (std::size_t i = 1; i < recording.time.size(); ++i)
    if (recording.time[i - 1] < span.to && recording.time[i] > span.from &&
        recording.time[i] - recording.time[i - 1] > kLongestGap * turn_s)
      throw InputError(recording.file, 0,
                       "no sample at " + seconds({recording.time[i - 1], recording.time[i]}) +
                           ", more than a quarter of a turn; sample faster, or give --cut FROM:TO beside it");
}

}  // namespace

double force_in(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const double force = table.number(row, column);
  if (!(std::abs(force) <= kLargestForce))
    table.fail(row, column, csv_number(force) + " is out of range; give N, up to " + csv_number(kLargestForce));
  return force;
}

ForceRecording read_force_recording(const std::filesystem::path& file) {
  const CsvTable table = read_csv(file);
  check_column_names(table, kForceColumns);
  std::array<std::size_t, 4> columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) columns.at(i) = table.require_column(kForceColumns.at(i));
  ForceRecording recording{.file = table.file(), .time = {}, .force = {}};
  for (const CsvRow& row : table.rows()) {
    const double time = table.number(row, columns[0]);
    if (!recording.time.empty() && !(time > recording.time.back()))
      table.fail(
          row, columns[0],
          csv_number(time) + " does not come after " + csv_number(recording.time.back()) + "; sort the rows by time");
    recording.time.push_back(time);
    recording.force.emplace_back(force_in(table, row, columns[1]), force_in(table, row, columns[2]),
                                 force_in(table, row, columns[3]));
  }
  if (recording.time.size() < 2)
    throw InputError(table.file(), table.header_line(), "holds no two samples; add the recorded rows");
  return recording;
}

SteadyForce steady_force(const ForceRecording& recording, double turn_s, double turns_to_axis,
                         const ForceWindows& windows) {
  const ForceIntegral integral(recording);
  const Offset offset(recording, integral, windows.zero);
  SteadyForce steady;
  if (windows.cut) check_inside(recording, *windows.cut, "--cut");
  const RecordedSpan cut =
      windows.cut ? *windows.cut : cutting_span(recording, integral, offset, turn_s, turns_to_axis);
  steady.turns = static_cast<int>(std::floor((cut.to - cut.from) / turn_s + kRoundingTurns));
  if (steady.turns < 1)
    throw InputError(recording.file, 0, "--cut " + seconds(cut) + " is shorter than a turn of the spindle; widen it");
  steady.span = {cut.from, std::min(cut.from + steady.turns * turn_s, recording.time.back())};
  check_samples(recording, steady.span, turn_s);
  for (const RecordedSpan& air : windows.zero)
    if (air.from < steady.span.to && air.to > steady.span.from)
      throw InputError(recording.file, 0,
                       "--zero " + seconds(air) + " overlaps the cut, " + seconds(steady.span) + "; give air only");
  steady.mean = offset.corrected(integral, steady.span);
  if (const int half = steady.turns / 2; half > 0) {
    const double middle = steady.span.from + half * turn_s, end = middle + half * turn_s;
    steady.drift =
        (offset.corrected(integral, {middle, end}) - offset.corrected(integral, {steady.span.from, middle})).norm();
  }
  return steady;
}

}  // namespace stillcut
