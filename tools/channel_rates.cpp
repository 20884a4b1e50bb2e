#include "tools/channel_rates.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "tools/styled_text.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kIntervalsBeforeGaps = 5;

std::string milliseconds_text(double seconds) {
  return std::isfinite(seconds) ? printf_text("%10.2f", 1e3 * seconds) : printf_text("%10s", "-");
}

}  // namespace

void ChannelRate::Sums::add(double interval) {
  least = intervals == 0 ? interval : std::min(least, interval);
  most = intervals == 0 ? interval : std::max(most, interval);
  ++intervals;
  const double from_mean = interval - mean;
  mean += from_mean / static_cast<double>(intervals);
  squares += from_mean * (interval - mean);
}

IntervalSummary ChannelRate::summary(const Sums& sums) {
  if (sums.intervals == 0) return {sums.messages, sums.bytes, kNaN, kNaN, kNaN, kNaN};
  const double deviation =
      sums.intervals > 1 ? std::sqrt(sums.squares / static_cast<double>(sums.intervals - 1)) : kNaN;
  return {sums.messages, sums.bytes, sums.mean, sums.least, sums.most, deviation};
}

void ChannelRate::add(std::int64_t received_us, std::size_t bytes) {
  if (all_.messages > 0 && received_us < last_us_) {
    ++back_;
  } else if (all_.messages > 0) {
    const double interval = static_cast<double>(received_us - last_us_) * 1e-6;
    const IntervalSummary before = all();
    const bool even = all_.intervals >= kIntervalsBeforeGaps && before.deviation < 0.5 * before.mean;
    if (even && interval > kGapMeans * before.mean) ++gaps_;
    all_.add(interval);
    period_.add(interval);
  }
  for (Sums* sums : {&all_, &period_}) {
    ++sums->messages;
    sums->bytes += static_cast<std::int64_t>(bytes);
  }
  last_us_ = received_us;
}

void ChannelRates::add(std::string_view channel, std::int64_t received_us, std::size_t bytes) {
  auto at = channels_.find(channel);
  if (at == channels_.end() && channels_.size() >= kMostChannels) {
    ++beyond_;
    return;
  }
  if (at == channels_.end()) at = channels_.try_emplace(std::string(channel)).first;
  at->second.add(received_us, bytes);
}

void ChannelRates::begin_period() {
  for (auto& [name, rate] : channels_) rate.begin_period();
}

std::string rates_text(const ChannelRates& rates, double period_s) {
  int wide = 20;
  for (const auto& [name, rate] : rates.channels()) wide = std::max(wide, width_of(printable(name)));
  std::string text = padded("channel", wide) + printf_text("%9s%10s%10s%10s%10s%10s%8s%12s\n", "1/s", "mean ms", "min",
                                                           "max", "std", "messages", "gaps", "bytes/s");
  for (const auto& [name, rate] : rates.channels()) {
    const IntervalSummary now = rate.period(), all = rate.all();
    text += padded(printable(name), wide) + printf_text("%9.2f", static_cast<double>(now.messages) / period_s) +
            milliseconds_text(all.mean) + milliseconds_text(all.least) + milliseconds_text(all.most) +
            milliseconds_text(all.deviation) +
            printf_text("%10lld%8lld%12.0f\n", static_cast<long long>(all.messages),
                        static_cast<long long>(rate.gaps()), static_cast<double>(now.bytes) / period_s);
  }
  if (rates.channels().empty()) text += "nothing was heard yet\n";
  if (rates.beyond() > 0)
    text += printf_text("and %lld messages on further channels: name the ones you want\n",
                        static_cast<long long>(rates.beyond()));
  return text;
}

}  // namespace stillcut
