#include "tools/scope_timeline.hpp"

#include "drivers/files/scenario.hpp"
#include "tools/closed_loop.hpp"
#include "tools/progress.hpp"
#include "tools/telemetry.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kHealthTold_ns = 1'000'000'000;
// What lies further back was decided in a silence, of which nothing is known before the next frame.
constexpr std::int64_t kSilence_ns = 200'000'000;

// What plays and simulates alike tell of, as the daemon's telemetry would.
class TimelineMaker {
 public:
  TimelineMaker(const Cell& cell, TimelineFeed& feed)
      : feed_{feed}, telemetry_{cell, [this](const TelemetryMessage& message) { feed_.take(message); }} {}

  void add(const Pipeline& pipeline) {
    decoder_ = pipeline.decoder().counters();
    begin(pipeline.core().origin_ns());
    const Decoded& decoded = pipeline.decoded();
    for (int b = 0; b < decoded.blocks; ++b) telemetry_.add(decoded.block[static_cast<std::size_t>(b)]);
    tell(view_of(pipeline.core(), decoder_), pipeline.core().lobes());
  }
  void add(const Output& output, const Core& core) {
    begin(core.origin_ns());
    LoopView view = view_of(core, decoder_);
    std::int64_t stamp_ns = view.now_ns;
    switch (output.type) {
      case Output::Type::event:
        feed_.take(output.event);
        stamp_ns = output.event.stamp_ns;
        break;
      case Output::Type::correction:
        feed_.take(output.correction);
        stamp_ns = output.correction.stamp_ns;
        break;
      case Output::Type::status:  // the view says more
        stamp_ns = output.status.stamp_ns;
        break;
    }
    if (view.now_ns - stamp_ns > kSilence_ns) view.now_ns = stamp_ns;
    tell(view, core.lobes());
  }
  // Time zero; what was decided or heard before has set it.
  void begin(std::int64_t origin_ns) {
    if (!std::exchange(begun_, true)) feed_.begin(origin_ns);
  }

 private:
  void tell(const LoopView& view, const LobeDiagram* lobes) {
    telemetry_.add(view, lobes);
    if (view.now_ns - health_told_ns_ < kHealthTold_ns) return;
    health_told_ns_ = view.now_ns;
    feed_.take(telemetry_.health(health_told_ns_));
  }

  TimelineFeed& feed_;
  Telemetry telemetry_;
  DecoderCounters decoder_;
  bool begun_ = false;
  std::int64_t health_told_ns_ = 0;
};

}  // namespace

std::unique_ptr<TimelineFeed> timeline_of_recording(const Cell& cell, const PlaybackSource& source, FeedTitle title,
                                                    std::vector<std::string>& warnings) {
  auto feed = std::make_unique<TimelineFeed>(std::move(title));
  TimelineMaker maker{cell, *feed};
  const PlaybackSummary summary =
      play(cell, source, true, kInfinity,
           {.on_frame = [&](const Pipeline& pipeline) { maker.add(pipeline); },
            .on_output = [&](const Output& output, const Core& core) { maker.add(output, core); },
            .on_robot = {}});
  maker.begin(summary.origin_ns);
  warnings = summary.warnings;
  if (summary.loop_times) feed->take(*summary.loop_times);
  feed->finish(summary.origin_ns + static_cast<std::int64_t>(1e9 * summary.played_s));
  return feed;
}

std::unique_ptr<TimelineFeed> timeline_of_scenario(const Cell& cell, const std::string& scenario, FeedTitle title) {
  constexpr std::int64_t kOrigin_ns = 1'700'000'000'000'000'000;  // data time carries a date, always the same
  VirtualMachine machine{cell, read_scenario(scenario, cell), kOrigin_ns};
  auto feed = std::make_unique<TimelineFeed>(std::move(title));
  TimelineMaker maker{cell, *feed};
  Progress progress{"simulating"};
  (void)run_in_data_time(cell, machine, [&](double share) { progress.update(share); },
                         {.on_frame = [&](const Pipeline& pipeline) { maker.add(pipeline); },
                          .on_output = [&](const Output& output, const Core& core) { maker.add(output, core); }});
  progress.finish();
  feed->finish(machine.origin_ns() + static_cast<std::int64_t>(1e9 * machine.time()));
  return feed;
}

}  // namespace stillcut
