// How often messages come on each channel of a network, and how evenly: for `stillcut hz`. Times are given, no clock.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace stillcut {

// The intervals between the messages of a channel, s; of fewer than two messages NaN.
struct IntervalSummary {
  std::int64_t messages = 0, bytes = 0;
  double mean = 0.0, least = 0.0, most = 0.0, deviation = 0.0;
};

class ChannelRate {
 public:
  // An interval that is longer than this many means of those before it is a gap, of channels that are even: those whose
  // deviation until then is below half their mean.
  static constexpr double kGapMeans = 2.5;

  void add(std::int64_t received_us, std::size_t bytes);
  // Since the start, or since the last begin_period().
  [[nodiscard]] IntervalSummary all() const { return summary(all_); }
  [[nodiscard]] IntervalSummary period() const { return summary(period_); }
  [[nodiscard]] std::int64_t gaps() const { return gaps_; }
  // Stamps that went back: the clock was set.
  [[nodiscard]] std::int64_t back() const { return back_; }
  void begin_period() { period_ = {}; }

 private:
  struct Sums {
    std::int64_t messages = 0, bytes = 0, intervals = 0;
    double mean = 0.0, squares = 0.0, least = 0.0, most = 0.0;  // Welford's
    void add(double interval);
  };
  static IntervalSummary summary(const Sums& sums);

  Sums all_, period_;
  std::int64_t last_us_ = 0, gaps_ = 0, back_ = 0;
};

class ChannelRates {
 public:
  static constexpr std::size_t kMostChannels = 1000;  // names come from the network: no more are kept

  void add(std::string_view channel, std::int64_t received_us, std::size_t bytes);
  void begin_period();
  [[nodiscard]] const std::map<std::string, ChannelRate, std::less<>>& channels() const { return channels_; }
  // Messages on channels beyond the most that are kept.
  [[nodiscard]] std::int64_t beyond() const { return beyond_; }

 private:
  std::map<std::string, ChannelRate, std::less<>> channels_;
  std::int64_t beyond_ = 0;
};

// A table, a row a channel; ends with a line feed.
std::string rates_text(const ChannelRates& rates, double period_s);

}  // namespace stillcut
