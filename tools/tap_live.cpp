#include "tools/tap_live.hpp"

#include <chrono>
#include <iostream>
#include <memory>
#include <thread>

#include "drivers/can/can_bus.hpp"

namespace stillcut {
namespace {

constexpr std::chrono::milliseconds kTapPoll{2};
constexpr std::chrono::seconds kTapSilence{5};  // then the operator is told what is not heard

// Hits from a bus. A log waits for whoever asks; on a live bus what was sent while nobody asked is passed over.
class BusTaps {
 public:
  BusTaps(const std::string& bus, TapListener& listener)
      : name_{bus},
        listener_{listener},
        bus_{open_can_bus(bus, listener.ids_used())},
        is_log_{bus.starts_with("log:")} {}

  HeardTap next() {
    told_ = false;
    heard_at_ = Clock::now();
    heard_ = listener_.blocks();
    for (;;) {
      while (next_ < count_)
        if (auto heard = listener_.add(frames_.at(next_++))) return std::move(*heard);
      count_ = bus_->receive(frames_);
      next_ = 0;
      if (count_ > 0) continue;
      if (bus_->state() == BusState::ended) throw InputError(name_, 0, "ends before the hits that are asked for");
      tell_silence();
      std::this_thread::sleep_for(kTapPoll);
    }
  }

  void forget() {
    if (is_log_) return;
    while (bus_->receive(frames_) > 0) {
    }
    next_ = count_ = 0;
    listener_.restart();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void tell_silence() {
    const auto blocks = listener_.blocks();
    const bool both = blocks[0] != heard_[0] && blocks[1] != heard_[1];
    if (both) {
      heard_ = blocks;
      heard_at_ = Clock::now();
    }
    if (told_ || Clock::now() - heard_at_ < kTapSilence) return;
    told_ = true;
    std::cerr << "stillcut: " << name_ << ": nothing heard of the "
              << (blocks[0] == heard_[0] ? "accelerometer" : "hammer")
              << " for 5 s; is it on, and are its names right?\n";
  }

  std::string name_;
  TapListener& listener_;
  std::unique_ptr<CanBus> bus_;
  bool is_log_;
  std::array<CanFrame, 64> frames_{};
  std::size_t next_ = 0, count_ = 0;
  bool told_ = false;
  Clock::time_point heard_at_;
  std::array<std::int64_t, 2> heard_{};
};

void check_postures(const LiveTapOptions& options) {
  for (const std::string& posture : options.postures) {
    if (posture.empty() || posture.front() == '.' || posture.find('/') != std::string::npos)
      throw InputError("posture '" + posture + "'", 0, "is no name of a file; give another id");
    const std::filesystem::path file = options.out / (posture + options.ending);
    if (std::error_code error; !options.replace && std::filesystem::exists(file, error))
      throw InputError(file.string(), 0, "is there already; choose another --out, or --replace it");
  }
}

}  // namespace

std::vector<TappedPosture> tap_live(const Cell& cell, const LiveTapOptions& options, std::istream& answers,
                                    std::ostream& out) {
  check_postures(options);
  TapListener listener(cell, options.sensor, options.settings);
  TapSettings settings = listener.settings();
  if (options.highest_hz > 0.0) settings.highest_of_rate = options.highest_hz / listener.sample_rate_hz();
  require_tap_settings(settings);
  BusTaps taps(options.bus.empty() ? cell.can->bus : options.bus, listener);
  const TapSource source{[&] { return taps.next(); }, [&] { taps.forget(); }};
  std::vector<TappedPosture> postures;
  for (const std::string& posture : options.postures) {
    TappedPosture tapped{posture, {}, {}};
    bool quit = false;
    for (const HammerDirection hammer : options.directions) {
      listener.set_direction(hammer.axis, hammer.sense);
      auto direction = ask_for_taps({posture, hammer, options.hits}, settings, source, answers, out);
      quit = !direction;
      if (quit) break;
      write_taps(options.out / "taps" / (posture + "-" + "xyz"[hammer.axis] + ".uff"), *direction);
      tapped.directions.push_back(std::move(*direction));
      tapped.response = responses_of(tapped.directions, options.estimator);
      write_frf(options.out / (posture + options.ending), tapped.response, options.form);
    }
    if (!tapped.directions.empty()) postures.push_back(std::move(tapped));
    if (!options.places.empty()) write_measured_places(options.out, options.places, options.ending);
    if (quit) break;
  }
  return postures;
}

}  // namespace stillcut
