#include "tools/tuning_replay.hpp"

#include <algorithm>
#include <atomic>

#include "drivers/can/candump_log.hpp"
#include "tools/pipeline.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut {
namespace {

constexpr double kBytesOfFrame = 150.0;  // in a log, about; for the bar only
constexpr std::int64_t kFramesToTell = 4096;

struct Playing {
  const Cell& cell;
  const LobeDiagram& lobes;
  std::atomic<std::int64_t>& frames_played;
};

bool cutting(State state) { return state == State::entry || state == State::cut || state == State::chatter; }

// When the tool cuts, from view to view.
class CutTimes {
 public:
  void add(const MonitorView& view, std::int64_t origin_ns) {
    if (view.stamp_ns <= last_ns_) return;
    const double at_s = static_cast<double>(view.stamp_ns - origin_ns) * 1e-9;
    if (last_ns_ > 0 && cutting(view.state)) {
      if (!spans_.empty() && spans_.back().to_s == last_s_) {
        spans_.back().to_s = at_s;
      } else {
        spans_.push_back({last_s_, at_s});
      }
    }
    last_ns_ = view.stamp_ns;
    last_s_ = at_s;
  }
  [[nodiscard]] const std::vector<LogSpan>& spans() const { return spans_; }

 private:
  std::vector<LogSpan> spans_;
  std::int64_t last_ns_ = 0;
  double last_s_ = 0.0;
};

struct HeardOnce {
  LogHearing hearing;
  double duration_s = 0.0;
  std::string warning;
};

HeardOnce hear(const Playing& playing, const std::filesystem::path& file, double limit) {
  Cell cell = playing.cell;
  cell.detection.limit = limit;
  Pipeline pipeline{cell};
  Core& core = pipeline.core();
  core.add_lobes(playing.lobes);
  CandumpReader log{file};
  OnsetCollector onsets;
  CutTimes cut;
  std::int64_t last_ns = 0;
  bool samples = false;
  CanFrame frame;
  while (log.next(frame)) {
    last_ns = std::max(last_ns, frame.stamp_ns);
    if (pipeline.feed(frame)) {
      samples = samples || pipeline.decoded().blocks > 0;
      cut.add(core.view(), core.origin_ns());
    }
    for (const Output& output : core.outputs()) {
      if (output.type != Output::Type::event) continue;
      onsets.add(output.event, static_cast<double>(output.event.stamp_ns - core.origin_ns()) * 1e-9);
    }
    core.clear_outputs();
    if (log.frames() % kFramesToTell == 0) playing.frames_played += kFramesToTell;
  }
  if (!samples)
    throw InputError(file.string(), 0, "holds no frame of the cell's accelerometers; is it of this cell's bus?");
  return {{onsets.onsets(), cut.spans()}, static_cast<double>(last_ns - core.origin_ns()) * 1e-9, log.warning()};
}

}  // namespace

void OnsetCollector::add(const Event& event, double time_s) {
  const bool of_structure = event.kind == ChatterKind::structural;
  if (event.type == EventType::chatter_onset) {
    const bool kind_told_later = unnamed_ && !of_structure;
    if (!kind_told_later) onsets_.push_back({time_s, event.kind});
    if (!of_structure) unnamed_ = event.kind == ChatterKind::unknown;
  }
  if ((event.type == EventType::chatter_end && !of_structure) || event.type == EventType::cut_exit) unnamed_ = false;
}

std::vector<HeardLog> hear_logs(const Cell& cell, const LobeDiagram& lobes, std::span<const std::filesystem::path> logs,
                                std::span<const double> limits, int jobs, const std::function<void(double)>& progress) {
  std::atomic<std::int64_t> frames_played{0};
  const Playing playing{cell, lobes, frames_played};
  double frames = 1.0;
  for (const auto& log : logs) {
    std::error_code no_size;
    frames += static_cast<double>(std::filesystem::file_size(log, no_size)) / kBytesOfFrame;
  }
  frames *= static_cast<double>(limits.size());

  // All logs at the first limit come first: a log that cannot be used is told of soon.
  std::vector<HeardOnce> heard(logs.size() * limits.size());
  run_tasks(
      heard.size(), jobs,
      [&](std::size_t task) { heard[task] = hear(playing, logs[task % logs.size()], limits[task / logs.size()]); },
      [&] { progress(static_cast<double>(frames_played) / frames); });

  std::vector<HeardLog> result(logs.size());
  for (std::size_t task = 0; task < heard.size(); ++task) {
    HeardLog& log = result[task % logs.size()];
    log.at_limit.push_back(std::move(heard[task].hearing));
    log.duration_s = heard[task].duration_s;
    log.warning = heard[task].warning;
  }
  return result;
}

}  // namespace stillcut
