// log:FILE[?speed=S]: a candump log as a bus. The whole file is read when the bus is opened (1.5 GB an hour for three
// axes at 25.6 kHz), so that receive() parses memory and makes no system call but the clock's.
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>

#include "drivers/can/bus_kinds.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/files/input_error.hpp"

namespace stillcut {
namespace {

class LogBus final : public CanBus {
 public:
  // speed: signal seconds per second of the steady clock; infinite: as fast as asked for.
  LogBus(const std::string& file, double speed) : reader_(file, {}, CandumpReader::Load::whole), speed_(speed) {
    pending_ = reader_.next(next_);
    first_stamp_ns_ = next_.stamp_ns;
  }

  std::size_t receive(std::span<CanFrame> frames) noexcept override {
    const double due_ns = due();
    std::size_t n = 0;
    for (; n < frames.size() && pending_ && static_cast<double>(next_.stamp_ns - first_stamp_ns_) <= due_ns; ++n) {
      frames[n] = next_;
      counted_.delivered(next_);
      pending_ = reader_.next(next_);
    }
    counted_.frames_bad.set(reader_.frames_bad());
    if (!pending_) ended_.store(true, std::memory_order_relaxed);
    return n;
  }

  bool send(const CanFrame& /*frame*/) noexcept override { return false; }

  [[nodiscard]] BusState state() const noexcept override {
    return ended_.load(std::memory_order_relaxed) ? BusState::ended : BusState::up;
  }

  [[nodiscard]] BusCounters counters() const noexcept override { return counted_.copy(); }

 private:
  // Log time since its first frame that has passed by now; it begins to run with the first call.
  double due() noexcept {
    if (!std::isfinite(speed_)) return std::numeric_limits<double>::infinity();
    const auto now = std::chrono::steady_clock::now();
    if (!started_) start_ = now;
    started_ = true;
    return speed_ * std::chrono::duration<double, std::nano>(now - start_).count();
  }

  CandumpReader reader_;
  double speed_;
  bool started_ = false;
  std::chrono::steady_clock::time_point start_;
  CanFrame next_;
  bool pending_ = false;
  std::int64_t first_stamp_ns_ = 0;
  CountedBus counted_;
  std::atomic<bool> ended_{false};
};

}  // namespace

std::unique_ptr<CanBus> open_log_bus(const std::string& file_and_speed) {
  constexpr std::string_view kOption = "?speed=";
  const std::size_t option = file_and_speed.rfind(kOption);
  if (option == std::string::npos) {
    return std::make_unique<LogBus>(file_and_speed, std::numeric_limits<double>::infinity());
  }
  const std::string file = file_and_speed.substr(0, option);
  const std::string value = file_and_speed.substr(option + kOption.size());
  double speed = 0.0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), speed);
  if (error != std::errc() || end != value.data() + value.size() || !(speed > 0.0) || !std::isfinite(speed)) {
    throw InputError("CAN bus 'log:" + file_and_speed + "'", 0, "speed is a number above 0; 1 is real time");
  }
  return std::make_unique<LogBus>(file, speed);
}

}  // namespace stillcut
