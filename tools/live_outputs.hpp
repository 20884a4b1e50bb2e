// What takes the real-time loop's outputs out of its rings, on ordinary threads: to LCM, to the events file, to the
// log, and the frames to a recording. Parts of a live run (live_run.hpp).
#pragma once

#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/lcm/publisher.hpp"
#include "tools/event_csv.hpp"
#include "tools/event_tally.hpp"
#include "tools/live_loop.hpp"

namespace stillcut {

// Takes the loop's outputs to LCM, to the events file and to the log; on an ordinary thread.
class PublisherThread {
 public:
  PublisherThread(LoopChannels& channels, const LcmConnection& lcm, const std::string& events_file, RuntimeMode mode,
                  std::function<void(const Output&)> on_output)
      : channels_{channels}, publisher_{lcm}, mode_{mode}, on_output_{std::move(on_output)} {
    if (events_file.empty()) return;
    events_.open(events_file, std::ios::binary);
    if (!events_) throw InputError(events_file, 0, "cannot be written; check the folder and its rights");
    write_event_header(events_);
    events_.flush();
  }

  void start() {
    thread_ = std::jthread{[this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        drain();
        // Clocks are set back, too.
        if (const std::int64_t now_ns = realtime_ns(); std::abs(now_ns - times_told_ns_) >= kTellTimesEvery_ns) {
          times_told_ns_ = now_ns;
          publisher_.publish(TelemetryMessage{latency_report(channels_.times, now_ns)});
        }
        std::this_thread::sleep_for(kPoll);
      }
    }};
  }

  // After the loop has ended: the rest of the ring, then the release that every end owes the controller.
  void finish() {
    thread_.request_stop();
    thread_.join();
    drain();
    if (mode_ == RuntimeMode::off) return;
    Correction release = last_;
    release.stamp_ns = realtime_ns();
    ++release.sequence;
    release.valid_for_ms = 500;
    release.mode = mode_;
    release.kind = CorrectionKind::release;
    release.feed_override = 1.0;
    release.reason = short_text("daemon ends");
    publisher_.publish(Output{release});
  }

  [[nodiscard]] const EventTally& tally() const { return tally_; }
  [[nodiscard]] const Publisher& publisher() const { return publisher_; }

 private:
  static constexpr std::chrono::milliseconds kPoll{2};
  static constexpr std::int64_t kTellTimesEvery_ns = 1'000'000'000;

  void drain() {
    Output output;
    while (channels_.outputs.pop(output)) {
      if (!publisher_.publish(output) && publisher_.failed() == 1) {
        spdlog::error("LCM: a message could not be sent; is the multicast route still there?");
      }
      if (on_output_) on_output_(output);
      if (output.type == Output::Type::correction) last_ = output.correction;
      if (output.type != Output::Type::event) continue;
      tally_.count(output.event);
      const std::int64_t origin = channels_.origin_ns.load(std::memory_order_relaxed);
      const auto level = output.event.type == EventType::fault ? spdlog::level::warn : spdlog::level::info;
      spdlog::log(level, "{}", event_line(output.event, origin));
      if (!events_.is_open()) continue;
      write_event(events_, output.event, origin);
      events_.flush();
    }
  }

  LoopChannels& channels_;
  Publisher publisher_;
  RuntimeMode mode_;
  std::function<void(const Output&)> on_output_;
  std::ofstream events_;
  EventTally tally_;
  Correction last_{};
  std::int64_t times_told_ns_ = 0;
  std::jthread thread_;
};

// Writes the frames that went into the core, and nothing else, as a plain candump log; on an ordinary thread.
class FrameLogThread {
 public:
  FrameLogThread(LoopChannels& channels, const std::string& file, std::string interface)
      : channels_{channels}, interface_{std::move(interface)}, file_{std::fopen(file.c_str(), "wb"), &std::fclose} {
    if (!file_) throw InputError(file, 0, "cannot be written; check the folder and its rights");
    thread_ = std::jthread{[this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        drain();
        std::this_thread::sleep_for(kPoll);
      }
    }};
  }
  void finish() {
    thread_.request_stop();
    thread_.join();
    drain();
  }

 private:
  static constexpr std::chrono::milliseconds kPoll{20};

  void drain() {
    CoreInput input;
    std::array<char, kMaxCandumpLine> line{};
    while (channels_.recorded.pop(input)) {
      if (const auto* frame = std::get_if<CanFrame>(&input))
        std::fwrite(line.data(), 1, format_candump_line(*frame, interface_, line), file_.get());
    }
    if (std::fflush(file_.get()) != 0 && !failed_) {
      failed_ = true;
      spdlog::error("recording stopped: cannot write (disk full?); monitoring goes on");
    }
  }

  LoopChannels& channels_;
  std::string interface_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  bool failed_ = false;
  std::jthread thread_;
};

}  // namespace stillcut
