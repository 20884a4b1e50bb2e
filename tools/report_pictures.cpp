#include "tools/report_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stillcut {
namespace {

constexpr double kLongestGapShown_s = 10.0;

double power_of(const std::vector<float>& values) {
  double mean = 0.0, square = 0.0, count = 0.0;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    mean += value;
    square += double{value} * value;
    count += 1.0;
  }
  return count < 1.0 ? -1.0 : square / count - mean / count * (mean / count);
}

template <class Timed>
void drop_before(std::vector<Timed>& things, double time_s) {
  things.erase(things.begin(),
               std::find_if(things.begin(), things.end(), [&](const Timed& thing) { return thing.time_s >= time_s; }));
}

}  // namespace

ReportPictures::ReportPictures(ReplayTrace blank, std::function<void(int, ReplayTrace)> done)
    : blank_{std::move(blank)}, done_{std::move(done)} {}

void ReportPictures::append(Strip& strip, const SampleStretch& stretch) const {
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if (stretch.axis[a].data() == nullptr) continue;
    strip.axis[a].insert(strip.axis[a].end(), static_cast<std::size_t>(stretch.missing), static_cast<float>(kNaN));
    strip.axis[a].insert(strip.axis[a].end(), stretch.axis[a].begin(), stretch.axis[a].end());
  }
  strip.end_s = stretch.begin_s + static_cast<double>(stretch.missing + stretch.samples) * stretch.step_s;
}

// At times only, so that what is kept is not moved with every frame.
void ReportPictures::forget_before(Strip& strip, double time_s) const {
  const auto keep = static_cast<std::size_t>(std::max(0.0, strip.end_s - time_s) * blank_.sample_rate_hz);
  for (auto& axis : strip.axis)
    if (axis.size() > keep) axis.erase(axis.begin(), axis.end() - static_cast<std::ptrdiff_t>(keep));
  drop_before(strip.trace, time_s);
  drop_before(strip.events, time_s);
}

void ReportPictures::add(const SampleStretch& stretch) {
  if (stretch.sensor != 0) return;
  if (static_cast<double>(stretch.missing) * stretch.step_s > kLongestGapShown_s) {
    finish();
    past_ = {};
  } else {
    append(past_, stretch);
    for (Strip& strip : open_) append(strip, stretch);
  }
  if (static_cast<double>(past_.axis[0].size() + past_.axis[1].size() + past_.axis[2].size()) >
      6.0 * kBefore_s * blank_.sample_rate_hz)
    forget_before(past_, past_.end_s - kBefore_s);
  for (std::size_t i = 0; i < open_.size();) {
    if (open_[i].end_s < open_[i].until_s) {
      ++i;
      continue;
    }
    complete(open_[i]);
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void ReportPictures::add(const TracePoint& point) {
  past_.trace.push_back(point);
  if (past_.trace.size() > 20'000) drop_before(past_.trace, point.time_s - kBefore_s);
  for (Strip& strip : open_) strip.trace.push_back(point);
}

void ReportPictures::add(const ReplayEvent& event) {
  past_.events.push_back(event);
  if (past_.events.size() > 1000) drop_before(past_.events, event.time_s - kBefore_s);
  for (Strip& strip : open_) strip.events.push_back(event);
}

void ReportPictures::begin(int number, double onset_s) {
  constexpr std::size_t kMostAtOnce = 4;
  if (open_.size() >= kMostAtOnce) return;
  open_.push_back(past_);
  forget_before(open_.back(), onset_s - kBefore_s);
  open_.back().number = number;
  open_.back().until_s = onset_s + kAfterOnset_s;
}

void ReportPictures::end_chatter(int number, double end_s) {
  for (Strip& strip : open_)
    if (strip.number == number) strip.until_s = std::min(strip.until_s, end_s + kAfterEnd_s);
}

void ReportPictures::finish() {
  for (Strip& strip : open_) complete(strip);
  open_.clear();
}

void ReportPictures::complete(Strip& strip) {
  ReplayTrace picture = blank_;
  auto strongest = std::max_element(strip.axis.begin(), strip.axis.end(),
                                    [](const auto& a, const auto& b) { return power_of(a) < power_of(b); });
  picture.vibration = std::move(*strongest);
  picture.start_s = strip.end_s - static_cast<double>(picture.vibration.size()) / picture.sample_rate_hz;
  picture.trace = std::move(strip.trace);
  picture.events = std::move(strip.events);
  const auto late = [&](const auto& thing) { return thing.time_s > strip.end_s; };
  std::erase_if(picture.trace, late);
  std::erase_if(picture.events, late);
  done_(strip.number, std::move(picture));
}

}  // namespace stillcut
