#include "tools/plot_replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "dsp/numbers.hpp"
#include "tools/spectrogram.hpp"

namespace stillcut {
namespace {

using plot::Band, plot::EventMark, plot::Figure, plot::Line, plot::Panel, plot::Scatter;

// printf for a few numbers into a string.
template <class... Numbers>
std::string format(const char* pattern, Numbers... numbers) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), pattern, numbers...);
  return text.data();
}

double end_time(const ReplayTrace& replay) {
  const double sound =
      replay.start_s + static_cast<double>(replay.vibration.size()) / std::max(replay.sample_rate_hz, 1.0);
  return std::max(sound, replay.trace.empty() ? 0.0 : replay.trace.back().time_s);
}

// Stretches of the trace in which `wanted` holds, as bands; only the first has the label.
template <class Wanted>
std::vector<Band> stretches(const ReplayTrace& replay, Wanted wanted, plot::Color color, double opacity,
                            const char* label) {
  std::vector<Band> bands;
  bool open = false;
  for (const TracePoint& point : replay.trace) {
    if (open) bands.back().end = point.time_s;
    if (wanted(point.state) && !open)
      bands.push_back({point.time_s, point.time_s, color, opacity, bands.empty() ? label : ""});
    open = wanted(point.state);
  }
  return bands;
}

std::vector<Band> cut_and_chatter_bands(const ReplayTrace& replay) {
  const auto in_cut = [](State s) { return s == State::entry || s == State::cut || s == State::exit; };
  std::vector<Band> bands = stretches(replay, in_cut, plot::kSkyBlue, 0.16, "tool in cut");
  const std::vector<Band> chatter = stretches(
      replay, [](State s) { return s == State::chatter; }, plot::kVermilion, 0.26, "chatter");
  bands.insert(bands.end(), chatter.begin(), chatter.end());
  return bands;
}

Panel vibration_panel(const ReplayTrace& replay) {
  Panel panel;
  panel.title = "Vibration at the tool";
  panel.y.label = "m/s²";
  Line line{.x = {}, .y = {}, .color = plot::kInk, .width = 0.8, .label = ""};
  for (std::size_t i = 0; i < replay.vibration.size(); ++i) {
    line.x.push_back(replay.start_s + static_cast<double>(i) / replay.sample_rate_hz);
    line.y.push_back(replay.vibration[i]);
  }
  panel.bands = cut_and_chatter_bands(replay);
  panel.lines.push_back(std::move(line));
  return panel;
}

double median_speed_rpm(const ReplayTrace& replay) {
  std::vector<double> speeds;
  for (const TracePoint& point : replay.trace)
    if (point.spindle_speed_rpm > 0.0) speeds.push_back(point.spindle_speed_rpm);
  if (speeds.empty()) return 0.0;
  std::nth_element(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2), speeds.end());
  return speeds[speeds.size() / 2];
}

// High enough to show the chatter with its first sidebands and several tooth harmonics.
double highest_shown_hz(const ReplayTrace& replay) {
  double highest = 6.5 * median_speed_rpm(replay) / 60.0 * replay.teeth;
  for (const ReplayEvent& event : replay.events)
    if (event.type == EventType::chatter_onset && std::isfinite(event.frequency_hz))
      highest = std::max(highest, 2.2 * event.frequency_hz);
  return std::min(highest > 0.0 ? highest : 2000.0, 0.5 * replay.sample_rate_hz);
}

Panel spectrogram_panel(const ReplayTrace& replay) {
  constexpr double kWindow = 0.09;  // s: resolves lines some 20 Hz apart, still follows an onset
  constexpr int kMaxHarmonics = 20;
  constexpr plot::Color kWhite{1.0, 1.0, 1.0};
  Panel panel;
  panel.title = "Spectrogram";
  panel.y.label = "frequency [Hz]";
  panel.height = 1.9;
  const double highest = highest_shown_hz(replay);
  panel.image = spectrogram(replay.vibration, replay.sample_rate_hz, replay.start_s, kWindow, highest);
  if (panel.image->columns == 0) panel.image.reset();
  const double tooth_hz = median_speed_rpm(replay) / 60.0 * replay.teeth;
  for (int harmonic = 1; tooth_hz > 0.0 && harmonic <= kMaxHarmonics && harmonic * tooth_hz < highest; ++harmonic) {
    Line line{.x = {},
              .y = {},
              .color = kWhite,
              .width = 1.0,
              .dashed = true,
              .opacity = 0.75,
              .label = harmonic == 1 ? "tooth passing and harmonics" : ""};
    for (const TracePoint& point : replay.trace) {
      line.x.push_back(point.time_s);
      line.y.push_back(point.spindle_speed_rpm > 0.0 ? harmonic * replay.teeth * point.spindle_speed_rpm / 60.0 : kNaN);
    }
    panel.lines.push_back(std::move(line));
  }
  // A marker now and then, so that the line under them stays visible.
  Scatter markers{.x = {}, .y = {}, .color = plot::kVermilion, .size = 6.0, .label = "detected chatter frequency"};
  const double spacing = (end_time(replay) - replay.start_s) / 110.0;
  for (const TracePoint& point : replay.trace) {
    if (!std::isfinite(point.chatter_frequency_hz)) continue;
    if (!markers.x.empty() && point.time_s < markers.x.back() + spacing) continue;
    markers.x.push_back(point.time_s);
    markers.y.push_back(point.chatter_frequency_hz);
  }
  if (!markers.x.empty()) panel.points.push_back(std::move(markers));
  return panel;
}

const char* chatter_label(ChatterKind kind) {
  switch (kind) {
    case ChatterKind::regenerative:
      return "regenerative chatter";
    case ChatterKind::structural:
      return "structural chatter";
    default:
      return "chatter";
  }
}

std::vector<EventMark> event_marks(const ReplayTrace& replay) {
  std::vector<EventMark> marks;
  for (const ReplayEvent& event : replay.events) {
    switch (event.type) {
      case EventType::chatter_onset:
        marks.push_back({event.time_s,
                         format("%.3f s  %s, %.0f Hz", event.time_s, chatter_label(event.kind), event.frequency_hz),
                         plot::kVermilion});
        break;
      case EventType::chatter_end:
        marks.push_back({event.time_s, "chatter ended", plot::kGreen});
        break;
      case EventType::cut_entry:
        marks.push_back({event.time_s, "entry", plot::kBlue});
        break;
      case EventType::cut_exit:
        marks.push_back({event.time_s, "exit", plot::kBlue});
        break;
      case EventType::fault:
        marks.push_back({event.time_s, "fault", plot::kPurple});
        break;
      case EventType::forced_vibration:
        marks.push_back({event.time_s, "forced vibration", plot::kOrange});
        break;
      case EventType::correction:
        break;  // in the panel of the speed
    }
  }
  return marks;
}

Panel indicator_panel(const ReplayTrace& replay) {
  Panel panel;
  panel.title = "Chatter indicator";
  panel.y = {.label = "times the alarm limit", .min = 0.05, .logarithmic = true};
  Line line{.x = {}, .y = {}, .color = plot::kBlue, .width = 1.3, .label = ""};
  double highest = 10.0;
  for (const TracePoint& point : replay.trace) {
    line.x.push_back(point.time_s);
    line.y.push_back(point.indicator);
    if (std::isfinite(point.indicator)) highest = std::max(highest, point.indicator);
  }
  panel.y.max = 6.0 * highest;  // room for the texts of events
  panel.lines.push_back(std::move(line));
  panel.limits.push_back({1.0, "alarm limit", plot::kVermilion});
  panel.events = event_marks(replay);
  return panel;
}

// A margin that fades: the decay goes to zero.
Panel decay_panel(const ReplayTrace& replay) {
  Panel panel;
  panel.title = "Decay of the mode that dies out slowest, before chatter";
  panel.y.label = "1/s";
  panel.height = 0.7;
  Line line{.x = {}, .y = {}, .color = plot::kGreen, .width = 1.6, .label = ""};
  for (const TracePoint& point : replay.trace) {
    line.x.push_back(point.time_s);
    line.y.push_back(point.decay_per_s);
  }
  panel.lines.push_back(std::move(line));
  panel.limits.push_back({0.0, "no margin left", plot::kVermilion});
  return panel;
}

double speed_at(const ReplayTrace& replay, double time_s) {
  const auto later = std::upper_bound(replay.trace.begin(), replay.trace.end(), time_s,
                                      [](double time, const TracePoint& point) { return time < point.time_s; });
  return later == replay.trace.begin() ? kNaN : std::prev(later)->spindle_speed_rpm;
}

// "correction: 9000 → 7490 rpm,  n = 60 f/(N k)  with f = 749 Hz, N = 2, k = 3"; once told, the numbers alone.
std::string correction_text(const ReplayTrace& replay, const ReplayEvent& event, bool in_full) {
  const double lobe = 60.0 * event.frequency_hz / (replay.teeth * event.spindle_speed_rpm), k = std::round(lobe);
  const bool on_lobe = k >= 1.0 && std::abs(lobe - k) < 0.02 * k;
  if (!in_full) return format("→ %.0f", event.spindle_speed_rpm) + (on_lobe ? format(", k = %.0f", k) : "");
  std::string text = format("correction: %.0f → %.0f rpm", speed_at(replay, event.time_s), event.spindle_speed_rpm);
  if (on_lobe)
    text += format(",  n = 60 f/(N k)  with f = %.0f Hz, N = %d, k = %.0f", event.frequency_hz, replay.teeth, k);
  return text;
}

Panel speed_panel(const ReplayTrace& replay) {
  Panel panel;
  panel.title = "Spindle speed";
  panel.y.label = "rpm";
  panel.height = 0.9;
  Line measured{.x = {}, .y = {}, .color = plot::kBlue, .width = 1.8, .label = "measured"};
  for (const TracePoint& point : replay.trace) {
    measured.x.push_back(point.time_s);
    measured.y.push_back(point.spindle_speed_rpm);
  }
  Line target{.x = {}, .y = {}, .color = plot::kOrange, .width = 2.2, .dashed = true, .label = "correction: target"};
  double low = kNaN, high = kNaN;  // of everything shown, fmin and fmax skip NaN
  for (const double rpm : measured.y) low = std::fmin(low, rpm), high = std::fmax(high, rpm);
  for (const ReplayEvent& event : replay.events) {
    const bool open = !target.x.empty() && std::isfinite(target.y.back());
    const bool ends = event.type == EventType::chatter_end || event.type == EventType::cut_exit;
    if (open && (ends || event.type == EventType::correction)) {
      target.x.insert(target.x.end(), {event.time_s, event.time_s});
      target.y.insert(target.y.end(), {target.y.back(), kNaN});
    }
    if (event.type != EventType::correction || !(event.spindle_speed_rpm > 0.0)) continue;
    target.x.push_back(event.time_s);
    target.y.push_back(event.spindle_speed_rpm);
    panel.events.push_back({event.time_s, correction_text(replay, event, panel.events.empty()), {0.62, 0.40, 0.0}});
    low = std::fmin(low, event.spindle_speed_rpm), high = std::fmax(high, event.spindle_speed_rpm);
  }
  if (!target.x.empty() && std::isfinite(target.y.back())) {
    target.x.push_back(end_time(replay));
    target.y.push_back(target.y.back());
  }
  const double room = std::max(0.25 * (high - low), 0.04 * high);  // the difference is to be seen, not the whole range
  if (std::isfinite(room)) {
    panel.y.min = low - room;
    panel.y.max = high + 3.0 * room;  // for the texts
  }
  for (const double limit : {replay.min_speed_rpm, replay.max_speed_rpm})
    if (limit > panel.y.min && limit < panel.y.max)
      panel.limits.push_back(
          {limit, limit == replay.min_speed_rpm ? "spindle's lowest" : "spindle's highest", plot::kGrey});
  panel.lines.push_back(std::move(measured));
  if (!target.x.empty()) panel.lines.push_back(std::move(target));
  return panel;
}

}  // namespace

Figure replay_figure(const ReplayTrace& replay) {
  Figure figure;
  figure.title = replay.title;
  figure.subtitle = replay.subtitle;
  figure.x = {.label = "time [s]", .min = std::min(replay.start_s, 0.0), .max = end_time(replay)};
  figure.height = 1080;
  figure.panels = {vibration_panel(replay), spectrogram_panel(replay), indicator_panel(replay), speed_panel(replay)};
  const auto told = [](const TracePoint& point) { return std::isfinite(point.decay_per_s); };
  if (std::any_of(replay.trace.begin(), replay.trace.end(), told)) {
    figure.panels.insert(figure.panels.begin() + 3, decay_panel(replay));
    figure.height += 120;
  }
  for (EventMark mark : event_marks(replay)) {  // the same moments in the panels above, without words
    mark.text.clear();
    figure.panels[0].events.push_back(mark);
  }
  return figure;
}

void plot_replay(const ReplayTrace& replay, const std::filesystem::path& file) {
  plot::write_figure(replay_figure(replay), file);
}

}  // namespace stillcut
