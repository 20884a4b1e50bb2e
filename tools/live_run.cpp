#include "tools/live_run.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "drivers/lcm/subscriber.hpp"
#include "rt/periodic.hpp"
#include "rt/syscall_filter.hpp"
#include "rt/thread.hpp"
#include "tools/live_loop.hpp"
#include "tools/live_outputs.hpp"
#include "tools/live_telemetry.hpp"
#include "tools/predictor.hpp"
#include "tools/real_time_check.hpp"
#include "tools/recorder.hpp"
#include "tools/spoken.hpp"

namespace stillcut {
namespace {

constexpr std::chrono::milliseconds kPollModel{5};

// Where the bus name ends in a log, it is played in real time: a daemon lives in real time.
std::string live_bus(const std::string& bus) {
  const bool is_log = bus.starts_with("log:");
  return is_log && bus.find("?speed=") == std::string::npos ? bus + "?speed=1" : bus;
}

std::string interface_name(const std::string& bus) {
  if (bus.starts_with("socketcan:")) return bus.substr(10);
  return "can0";
}

double us(std::int64_t ns) { return static_cast<double>(ns) * 1e-3; }

nlohmann::ordered_json summary_json(const Pipeline& pipeline, const CanBus& bus, const LoopChannels& channels,
                                    const PublisherThread& publisher) {
  const BusCounters can = bus.counters();
  const LoopStatistics& loop = channels.times.loop;
  const LatencySummary wake = loop.wakeup.summary(), tick = loop.execution.summary();
  nlohmann::ordered_json json{{"frames", pipeline.core().counters().frames},
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
                              {"skipped", loop.skipped.load()},
                              {"times_out", channels.times.times_out.load()},
                              {"wakeup_p50_us", us(wake.p50_ns)},
                              {"wakeup_p99_us", us(wake.p99_ns)},
                              {"wakeup_max_us", us(wake.max_ns)},
                              {"tick_p50_us", us(tick.p50_ns)},
                              {"tick_p9999_us", us(tick.p9999_ns)},
                              {"tick_max_us", us(tick.max_ns)}};
  for (const NamedLatency& stage : named_latencies(channels.times)) {
    json["latency_us"][stage.name] = {{"count", stage.times.count},
                                      {"p50", us(stage.times.p50_ns)},
                                      {"p99", us(stage.times.p99_ns)},
                                      {"p99.9", us(stage.times.p999_ns)},
                                      {"max", us(stage.times.max_ns)}};
  }
  return json;
}

bool is_plain_log(const std::string& record) {
  return record.ends_with(".log") && !std::filesystem::is_directory(record);
}

// The folder to record into and how; no folder: none.
RecordingSettings recording_settings(const Cell& cell, const LiveRunOptions& options) {
  RecordingSettings settings = cell.recording;
  if (is_plain_log(options.record) || !options.cell_records) settings.folder.clear();
  if (!options.record.empty() && !is_plain_log(options.record)) settings.folder = options.record;
  return settings;
}

bool records(const Cell& cell, const LiveRunOptions& options) {
  return is_plain_log(options.record) || !recording_settings(cell, options).folder.empty();
}

void add_recording(nlohmann::ordered_json& summary, const RecorderCounters& recorded) {
  summary["recorded_frames"] = recorded.frames;
  summary["recorded_messages"] = recorded.messages;
  summary["recorded_bytes"] = recorded.bytes;
  summary["recorded_marks"] = recorded.marks;
  summary["record_lost"] = recorded.lost;
  summary["record_stops"] = recorded.stops;
}

}  // namespace

// Order matters: what is declared first outlives the threads that use it.
struct LiveRun::Parts {
  Parts(const Cell& cell, const std::string& bus_name, const LcmConnection& lcm, const LiveRunOptions& options);
  void run_model(const std::stop_token& stop);
  void stop();

  Pipeline pipeline;
  std::optional<Predictor> predictor;  // none while the machine is measured
  std::unique_ptr<CanBus> bus;
  std::unique_ptr<LoopChannels> channels;
  PublisherThread publisher;
  std::optional<FrameLogThread> frame_log;
  std::unique_ptr<Recorder> recorder;
  Snapshot<RobotState> newest_state;  // now and then a state is for the model thread, every message for the loop
  Snapshot<RobotPath> newest_path;    // for the model thread alone
  PredictionPace pace;                // the subscriber thread's
  std::jthread model;
  std::optional<Subscriber> subscriber;
  std::optional<TelemetryThread> telemetry;
  std::optional<LoopSyscallFilter> audit;
  std::atomic<bool> stop_loop{false}, loop_ended{false};
  std::optional<LiveLoop> live;
  std::optional<RealTimeThread> loop;
  bool stopped = false;
};

LiveRun::Parts::Parts(const Cell& cell, const std::string& bus_name, const LcmConnection& lcm,
                      const LiveRunOptions& options)
    : pipeline{cell},
      channels{std::make_unique<LoopChannels>(records(cell, options), options.telemetry)},
      publisher{*channels, lcm, options.events, cell.mode, [this, on_output = options.on_output](const Output& output) {
                  if (recorder) recorder->add_output(output);
                  if (on_output) on_output(output);
                }} {
  if (!cell.measures) {
    const NominalPrediction prediction = predictor.emplace(cell).nominal();
    if (!prediction.warning.empty()) spdlog::warn(prediction.warning);
    pipeline.core().add_lobes(prediction.diagram);
    channels->shown_lobes.publish(prediction.diagram);
  }
  const RealTimeSettings real_time{.priority = options.priority, .cpu = options.cpu};
  if (cell.mode == RuntimeMode::active && !options.allow_not_real_time) require_real_time(real_time);
  // After what takes time: no frame waits for it, and where real time is refused no recording is begun.
  bus = open_can_bus(bus_name, pipeline.decoder().ids_used());
  if (is_plain_log(options.record)) frame_log.emplace(*channels, options.record, interface_name(bus_name));
  if (const RecordingSettings settings = recording_settings(cell, options); !settings.folder.empty())
    recorder = std::make_unique<Recorder>(*channels, settings, interface_name(bus_name));
  if (predictor) model = std::jthread{[this](const std::stop_token& stop) { run_model(stop); }};
  RobotHandlers handlers;
  handlers.on_state = [this](const RobotState& state) {
    (void)channels->messages.push(state);
    if (pace.due(state)) newest_state.publish(state);
  };
  handlers.on_ack = [this](const CorrectionAck& ack) { (void)channels->messages.push(ack); };
  handlers.on_path = [this](const RobotPath& path) {
    newest_path.publish(path);
    if (recorder) recorder->add_path(path);
  };
  handlers.on_bad = [](std::string_view channel, const char* why) { spdlog::warn("{}: {}", channel, why); };
  subscriber.emplace(lcm, realtime_ns, handlers);

  if (options.audit) audit.emplace();
  live.emplace(*bus, pipeline, *channels, !bus_name.starts_with("log:"), records(cell, options),
               !options.allow_not_real_time, realtime_ns, options.telemetry);
  if (options.telemetry)
    telemetry.emplace(cell, pipeline.decoder(), *channels, lcm, [this] {
      return LiveLosses{bus->state(),
                        bus->counters(),
                        static_cast<std::int64_t>(channels->outputs.refused()),
                        static_cast<std::int64_t>(channels->recorded.refused()),
                        static_cast<std::int64_t>(channels->watched.refused()),
                        subscriber->bad(),
                        publisher.publisher().failed()};
    });
  publisher.start();
  loop.emplace(real_time, [this] {
    if (audit && audit->install() != 0) std::abort();
    run_periodic(kLoopPeriodNs, stop_loop, channels->times.loop,
                 [this](std::int64_t awake_ns) noexcept { return live->tick(awake_ns); });
    if (audit) audit->release();
    loop_ended.store(true, std::memory_order_release);
  });
  if (!loop->report().complete()) spdlog::warn("not fully real-time: {}", loop->report().reasons);
  spdlog::info("stillcutd runs: {} on {}, mode {}", cell.file.string(), bus_name,
               cell.measures ? "measure" : mode_name(cell.mode));
}

void LiveRun::Parts::run_model(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (newest_state.update()) {
      if (const auto diagram = predictor->at(newest_state.value())) {
        channels->lobes.publish(
            {*diagram, recorder ? recorder->add_question(encode(predictor->answered()), false) : 0});
        channels->shown_lobes.publish(*diagram);
      }
    }
    if (newest_path.update()) {
      const RobotPath& path = newest_path.value();
      channels->ahead.publish({predictor->along(path), recorder ? recorder->add_question(encode(path), true) : 0});
    }
    std::this_thread::sleep_for(kPollModel);
  }
}

void LiveRun::Parts::stop() {
  if (stopped) return;
  stopped = true;
  stop_loop.store(true, std::memory_order_release);
  loop->join();
  publisher.finish();
  telemetry.reset();
  if (frame_log) frame_log->finish();
  if (recorder) recorder->finish();
}

LiveRun::LiveRun(const Cell& cell, const std::string& bus, const LcmConnection& lcm, const LiveRunOptions& options)
    : parts_{std::make_unique<Parts>(cell, live_bus(bus), lcm, options)} {}

LiveRun::~LiveRun() { parts_->stop(); }

bool LiveRun::ended() const { return parts_->loop_ended.load(std::memory_order_acquire); }

std::uint64_t LiveRun::ticks() const { return parts_->channels->times.loop.ticks.load(std::memory_order_relaxed); }

void LiveRun::stop() { parts_->stop(); }

void LiveRun::mark(const std::string& why) {
  if (parts_->recorder) parts_->recorder->mark(why);
}

nlohmann::ordered_json LiveRun::summary() const {
  auto summary = summary_json(parts_->pipeline, *parts_->bus, *parts_->channels, parts_->publisher);
  if (parts_->recorder) add_recording(summary, parts_->recorder->counters());
  return summary;
}

TickTimes LiveRun::tick_times() const {
  const LatencySummary tick = parts_->channels->times.loop.execution.summary();
  return {us(tick.p50_ns), us(tick.p9999_ns), us(tick.max_ns)};
}

}  // namespace stillcut
