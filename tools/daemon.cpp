#include "tools/daemon.hpp"

#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/cell.hpp"
#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/publisher.hpp"
#include "drivers/lcm/subscriber.hpp"
#include "rt/periodic.hpp"
#include "rt/syscall_filter.hpp"
#include "rt/thread.hpp"
#include "tools/event_csv.hpp"
#include "tools/event_tally.hpp"
#include "tools/live_loop.hpp"
#include "tools/predictor.hpp"

namespace stillcut {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPollOutputs{2}, kPollRecord{20}, kPollModel{5};

// Where the bus name ends in a log, it is played in real time: a daemon lives in real time.
std::string live_bus(const std::string& bus) {
  const bool is_log = bus.starts_with("log:");
  return is_log && bus.find("?speed=") == std::string::npos ? bus + "?speed=1" : bus;
}

std::string interface_name(const std::string& bus) {
  if (bus.starts_with("socketcan:")) return bus.substr(10);
  return "can0";
}

// Takes the loop's outputs to LCM, to the events file and to the log; on an ordinary thread.
class PublisherThread {
 public:
  PublisherThread(LoopChannels& channels, const LcmConnection& lcm, const std::string& events_file, RuntimeMode mode)
      : channels_{channels}, publisher_{lcm}, mode_{mode} {
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
        std::this_thread::sleep_for(kPollOutputs);
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
  void drain() {
    Output output;
    while (channels_.outputs.pop(output)) {
      if (!publisher_.publish(output) && publisher_.failed() == 1) {
        spdlog::error("LCM: a message could not be sent; is the multicast route still there?");
      }
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
  std::ofstream events_;
  EventTally tally_;
  Correction last_{};
  std::jthread thread_;
};

// Writes the frames that went into the core as a candump log; on an ordinary thread.
class RecorderThread {
 public:
  RecorderThread(LoopChannels& channels, const std::string& file, std::string interface)
      : channels_{channels}, interface_{std::move(interface)}, file_{std::fopen(file.c_str(), "wb"), &std::fclose} {
    if (!file_) throw InputError(file, 0, "cannot be written; check the folder and its rights");
    thread_ = std::jthread{[this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        drain();
        std::this_thread::sleep_for(kPollRecord);
      }
    }};
  }
  void finish() {
    thread_.request_stop();
    thread_.join();
    drain();
  }

 private:
  void drain() {
    CanFrame frame;
    std::array<char, kMaxCandumpLine> line{};
    while (channels_.recorded.pop(frame)) {
      std::fwrite(line.data(), 1, format_candump_line(frame, interface_, line), file_.get());
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

nlohmann::ordered_json summary_json(const Pipeline& pipeline, const CanBus& bus, const LoopChannels& channels,
                                    const LoopStatistics& loop, const PublisherThread& publisher) {
  const BusCounters can = bus.counters();
  const LatencySummary wake = loop.wakeup.summary(), tick = loop.execution.summary();
  const auto us = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-3; };
  return {{"frames", pipeline.core().counters().frames},
          {"frames_lost", pipeline.core().counters().frames_lost},
          {"frames_bad", can.frames_bad + pipeline.decoder().counters().frames_bad},
          {"frames_out_of_order", pipeline.core().counters().frames_out_of_order},
          {"kernel_dropped", can.dropped},
          {"error_frames", can.error_frames},
          {"bus_off", can.bus_off},
          {"reopened", can.reopened},
          {"chatter_onsets", publisher.tally().chatter_onsets},
          {"corrections", publisher.tally().corrections},
          {"faults", publisher.tally().faults},
          {"published", publisher.publisher().sent()},
          {"publish_failed", publisher.publisher().failed()},
          {"outputs_dropped", channels.outputs.refused()},
          {"record_dropped", channels.recorded.refused()},
          {"ticks", loop.ticks.load()},
          {"overruns", loop.overruns.load()},
          {"wakeup_p50_us", us(wake.p50_ns)},
          {"wakeup_p99_us", us(wake.p99_ns)},
          {"wakeup_max_us", us(wake.max_ns)},
          {"tick_p50_us", us(tick.p50_ns)},
          {"tick_p9999_us", us(tick.p9999_ns)},
          {"tick_max_us", us(tick.max_ns)}};
}

// Sleeps until a signal, the end of the loop, or the wanted duration.
void wait_for_the_end(const sigset_t& signals, const std::atomic<bool>& loop_ended, double duration_s) {
  const auto started = std::chrono::steady_clock::now();
  while (!loop_ended.load(std::memory_order_acquire)) {
    const timespec tenth{0, 100'000'000};
    if (const int signal = sigtimedwait(&signals, nullptr, &tenth); signal > 0) {
      spdlog::info("{} received", signal == SIGTERM ? "SIGTERM" : "SIGINT");
      return;
    }
    const std::chrono::duration<double> ran = std::chrono::steady_clock::now() - started;
    if (duration_s > 0.0 && ran.count() >= duration_s) return;
  }
}

}  // namespace

void run_daemon(const DaemonOptions& options) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("stillcutd", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_pattern("%H:%M:%S.%e %l %v");
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // before any thread: all inherit it, only this one waits for them

  const Cell cell = read_cell(options.cell);
  Pipeline pipeline{cell};
  Predictor predictor{cell};
  const NominalPrediction prediction = predictor.nominal();
  if (!prediction.warning.empty()) spdlog::warn(prediction.warning);
  pipeline.core().add_lobes(prediction.diagram);
  const LcmConnection lcm = open_lcm(cell.lcm_url);
  const std::string bus_name = live_bus(cell.can->bus);
  const std::unique_ptr<CanBus> bus = open_can_bus(bus_name, pipeline.decoder().ids_used());

  auto channels = std::make_unique<LoopChannels>();
  PublisherThread publisher{*channels, lcm, options.events, cell.mode};
  std::optional<RecorderThread> recorder;
  if (!options.record.empty()) recorder.emplace(*channels, options.record, interface_name(bus_name));

  // Prediction: now and then a state is for the model thread, every message for the loop.
  Snapshot<RobotState> newest_state;
  PredictionPace pace;  // the subscriber thread's
  std::jthread model{[&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (newest_state.update()) {
        if (const auto diagram = predictor.at(newest_state.value())) channels->lobes.publish(*diagram);
      }
      std::this_thread::sleep_for(kPollModel);
    }
  }};
  Subscriber subscriber{
      lcm,
      realtime_ns,
      {.on_state =
           [&](const RobotState& state) {
             (void)channels->messages.push(state);
             if (pace.due(state)) newest_state.publish(state);
           },
       .on_ack = [&](const CorrectionAck& ack) { (void)channels->messages.push(ack); },
       .on_bad = [](std::string_view channel, const char* why) { spdlog::warn("{}: {}", channel, why); }}};

  std::optional<LoopSyscallFilter> audit;
  if (options.audit) audit.emplace();
  std::atomic<bool> stop{false}, ended{false};
  LoopStatistics statistics;
  LiveLoop live{*bus, pipeline, *channels, !bus_name.starts_with("log:"), recorder.has_value()};
  publisher.start();
  {
    RealTimeThread loop{{.priority = options.priority, .cpu = options.cpu}, [&] {
                          if (audit && audit->install() != 0) std::abort();
                          run_periodic(kLoopPeriodNs, stop, statistics,
                                       [&](std::int64_t) noexcept { return live.tick(); });
                          if (audit) audit->release();
                          ended.store(true, std::memory_order_release);
                        }};
    if (!loop.report().complete()) spdlog::warn("not fully real-time: {}", loop.report().reasons);
    spdlog::info("stillcutd runs: {} on {}, mode {}", options.cell, cell.can->bus,
                 cell.mode == RuntimeMode::active   ? "active"
                 : cell.mode == RuntimeMode::shadow ? "shadow"
                                                    : "off");
    wait_for_the_end(signals, ended, options.duration_s);
    stop.store(true, std::memory_order_release);
    loop.join();
  }
  publisher.finish();
  if (recorder) recorder->finish();

  const nlohmann::ordered_json summary = summary_json(pipeline, *bus, *channels, statistics, publisher);
  if (options.json) {
    std::cout << summary.dump() << std::endl;
  } else {
    spdlog::info("ended: {}", summary.dump());
  }
}

}  // namespace stillcut
