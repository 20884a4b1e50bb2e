// Hears what is said on the bridge's topics in a domain, whoever says it: how many, how fast, what was lost, the newest
// in words. For integrators without ROS 2 at hand.
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "drivers/dds/dds_domain.hpp"

namespace stillcut {

struct HeardTopic {
  std::string topic;
  std::int64_t messages = 0;
  std::int64_t lost = 0;  // told by the numbers that every writer gives its samples
  int writers = 0;        // that speak now
  double rate_hz = 0.0;   // from the first to the last; 0 with fewer than two
  std::string newest;     // in words; empty: nothing yet
};

class TelemetryEar {
 public:
  // `name` heads the topics. Throws ComponentError.
  TelemetryEar(const DdsSettings& settings, const std::string& name);
  ~TelemetryEar();
  TelemetryEar(const TelemetryEar&) = delete;
  TelemetryEar& operator=(const TelemetryEar&) = delete;

  [[nodiscard]] std::vector<HeardTopic> heard() const;

  // Why nothing may have been heard, and what mends it, from who is in the domain: one line.
  [[nodiscard]] std::string advice() const;

 private:
  class Topic;
  template <class Type>
  class TypedTopic;

  void note_speaker(const FoundWriter& writer);

  DdsSettings settings_;
  mutable std::mutex mutex_;
  std::set<std::string> speakers_;  // the options that hear them
  std::vector<std::unique_ptr<Topic>> topics_;
  std::unique_ptr<DdsDomain> domain_;  // last: its threads call all else
};

}  // namespace stillcut
