// Publishes what the daemon tells over LCM on DDS, as ROS 2 nodes would: a topic a kind of message, rt/NAMESPACE/status
// and so on, and rt/diagnostics once a second.
#pragma once

#include <array>
#include <deque>
#include <mutex>

#include "drivers/dds/dds_domain.hpp"
#include "drivers/dds/diagnostics.hpp"

namespace stillcut {

class TelemetryBridge {
 public:
  static constexpr std::int64_t kTurn_ns = 5'000'000;

  // `name` heads the topics; `hardware_id` is for the diagnostics. Throws ComponentError.
  TelemetryBridge(const DdsSettings& settings, const std::string& name, const std::string& hardware_id);

  // Any one thread; times of a clock that never goes back.
  void hear(const TelemetryMessage& message, std::int64_t heard_ns);

  // The main thread, every kTurn_ns: what is not published as it comes. Vibration comes ten samples at a time, and
  // leaves one by one: a reader that keeps few has time to take them.
  void turn(std::int64_t now_ns, std::int64_t stamp_ns);

  // How many readers of any kind are connected; the main thread.
  [[nodiscard]] int readers() const;

  // Any thread.
  [[nodiscard]] std::int64_t written() const noexcept { return written_; }
  [[nodiscard]] std::int64_t failed() const noexcept { return failed_; }
  [[nodiscard]] int others() const noexcept { return domain_.others(); }
  [[nodiscard]] std::int64_t heard_ns() const noexcept { return heard_ns_; }  // of the newest message; 0: none yet

 private:
  enum Topic : std::uint8_t { status, indicator, spectrum, vibration, correction, event, lobes, diagnostics, count };

  template <class Sample>
  void write(Topic topic, Sample sample);

  DdsDomain domain_;
  std::array<eprosima::fastdds::dds::DataWriter*, Topic::count> writers_{};
  std::mutex mutex_;  // of the two below
  Diagnostics state_;
  std::deque<ImuSample> waiting_;
  std::int64_t diagnosed_ns_ = 0;
  std::atomic<std::int64_t> written_{0}, failed_{0}, heard_ns_{0};
};

}  // namespace stillcut
