#include "tools/report_page.hpp"

#include <algorithm>
#include <cmath>

#include "tools/report_figures.hpp"
#include "tools/report_html.hpp"
#include "tools/report_words.hpp"

namespace stillcut {
namespace {

using html::escaped;

std::string per_cent(double part, double whole) { return whole > 0.0 ? shown(100.0 * part / whole, 1) + " %" : "–"; }

std::string span_text(double begin_s, double end_s) { return std::isnan(end_s) ? "open" : shown(end_s - begin_s, 2); }

// The rows to be shown of so many: the worst, in their order.
template <class Thing>
std::vector<std::size_t> worst(const std::vector<Thing>& things) {
  std::vector<std::size_t> order(things.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  if (order.size() <= kMostReportRows) return order;
  const auto gravity = [&](std::size_t i) { return std::isnan(things[i].indicator) ? 0.0 : things[i].indicator; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gravity(a) > gravity(b); });
  order.resize(kMostReportRows);
  std::sort(order.begin(), order.end());
  return order;
}

std::string left_out(std::size_t all, const char* what) {
  if (all <= kMostReportRows) return {};
  return "<p class=\"soft\">Of " + std::to_string(all) + " " + what + " the " + std::to_string(kMostReportRows) +
         " with the highest indicator are listed; stillcut report --json has all.</p>\n";
}

void write_head(const Report& report, std::ostream& out) {
  const ReportVerdict verdict = verdict_of(report);
  const char* const gravity = verdict.gravity == Gravity::good      ? "good"
                              : verdict.gravity == Gravity::notable ? "notable"
                                                                    : "bad";
  out << "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n<meta "
         "charset=\"utf-8\"/>\n"
      << "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>Cutting report, "
      << escaped(utc_text(report.origin_ns)) << "</title>\n<style>" << html::style_sheet()
      << "</style>\n</head>\n<body>\n<main>\n<h1>Cutting report</h1>\n<p class=\"soft\">"
      << escaped(utc_text(report.origin_ns)) << ", " << duration_text(report.played_s) << ", from "
      << escaped(report.recording) << "</p>\n<div class=\"card verdict " << gravity << "\"><p>" << escaped(verdict.text)
      << "</p></div>\n";
  out << html::facts({{"Cell", report.cell},
                      {"Tool", report.tool},
                      {"Material", report.material},
                      {"Posture", report.posture},
                      {"Mode", mode_text(report.mode)},
                      {"Spindle", shown(report.min_rpm, 0) + " to " + shown(report.max_rpm, 0) + " rpm"},
                      {"Stillcut", STILLCUT_VERSION}});
  for (const std::string& warning : report.warnings) out << "<p class=\"soft\">" << escaped(warning) << "</p>\n";
  if (!report.from_the_start)
    out << "<p class=\"soft\">The beginning of this recording was deleted: the first seconds may be decided otherwise "
           "than live.</p>\n";
}

void write_timeline(const Report& report, std::ostream& out) {
  out << "<h2>Timeline</h2>\n<div class=\"card\">\n"
      << html::picture(timeline_figure(report), plot::Format::svg, "Indicator, vibration and spindle speed over time");
  const auto time_in = [&](State state) { return report.state_s.at(static_cast<std::size_t>(state)); };
  const double cut_s = time_in(State::entry) + time_in(State::cut) + time_in(State::exit);
  out << html::facts({{"In the cut, sound", duration_text(cut_s)},
                      {"Chatter", duration_text(time_in(State::chatter))},
                      {"Spindle turns in air", duration_text(time_in(State::air))},
                      {"Idle", duration_text(time_in(State::idle))},
                      {"Cannot tell", duration_text(time_in(State::cannot_tell) + time_in(State::fault))}});
  out << "<p class=\"soft\">Each point shows the worst of " << shown(report.timeline_step_s, 2) << " s.</p>\n</div>\n";
}

void write_cuts(const Report& report, std::ostream& out) {
  out << "<h2>Cuts</h2>\n";
  if (report.cuts.empty()) {
    out << "<p>No cut was recognised.</p>\n";
    return;
  }
  html::Table table{{"#", "begin [s]", "length [s]", "speed [rpm]", "depth [mm]", "indicator, max",
                     "vibration, max [m/s² rms]", "margin, predicted", "chatter [s]"},
                    {},
                    {}};
  for (const std::size_t i : worst(report.cuts)) {
    const ReportCut& cut = report.cuts[i];
    table.rows.push_back({std::to_string(i + 1), shown(cut.begin_s, 2), span_text(cut.begin_s, cut.end_s),
                          shown(cut.speed_rpm, 0), shown(cut.depth_mm, 2), shown(cut.indicator, 2), shown(cut.level, 1),
                          shown(cut.margin, 2), cut.episodes > 0 ? shown(cut.chatter_s, 2) : "–"});
    table.row_class.emplace_back(cut.episodes > 0 ? "chatter" : "");
  }
  out << "<div class=\"card\">\n" << html::table(table) << left_out(report.cuts.size(), "cuts");
  out << "<p class=\"soft\">Indicator: 1 is the alarm limit. Margin: limit depth over depth, less 1, the least "
         "predicted during the cut; "
         "above 0 is stable. Depth: "
      << (report.depth_from_robot ? "the deepest that the robot told."
                                  : "as the cell file has it; the robot told none.")
      << "</p>\n</div>\n";
}

std::string margin_text(const ReportCorrection& correction) {
  if (std::isnan(correction.margin_before) && std::isnan(correction.margin_after)) return "–";
  return shown(correction.margin_before, 2) + " → " + shown(correction.margin_after, 2);
}

std::string asked_text(const ReportCorrection& correction) {
  if (correction.first_sequence == 0) return correction.note;
  std::string speeds = shown(correction.from_rpm, 0) + " → " + shown(correction.target_rpm, 0) + " rpm";
  switch (correction.kind) {
    case CorrectionKind::spindle_speed:
      return speeds;
    case CorrectionKind::speed_variation:
    case CorrectionKind::feed_direction:
    case CorrectionKind::feed_override:
    case CorrectionKind::stop_request:
    case CorrectionKind::release:
      break;
  }
  const std::size_t mode_ends = correction.note.find(' ');  // "active no stable speed in reach: ..."
  return mode_ends == std::string::npos ? correction.note : correction.note.substr(mode_ends + 1);
}

void write_episode(const ReportEpisode& episode, std::size_t number, std::ostream& out) {
  out << "<div class=\"card\">\n<h3>Episode " << number + 1 << ": " << kind_text(episode.kind) << " chatter at "
      << shown(episode.frequency_hz, 0) << " Hz, " << shown(episode.onset_s, 2) << " s</h3>\n<p>It "
      << escaped(end_of(episode)) << ".</p>\n";
  const double change = episode.level_after / episode.level_before;
  out << html::facts(
      {{"Speed", shown(episode.speed_rpm, 0) + " rpm"},
       {"Depth", shown(episode.depth_mm, 2) + " mm"},
       {"Indicator, max", shown(episode.indicator, 2)},
       {"Predicted margin at the onset", shown(episode.margin, 2)},
       {"Lasted", std::isnan(episode.end_s) ? "" : shown(episode.end_s - episode.onset_s, 2) + " s"},
       {"Vibration while it chattered", shown(episode.level_before, 1) + " m/s² rms"},
       {"After it",
        std::isnan(change) ? "" : shown(episode.level_after, 1) + " m/s² rms (" + shown(100.0 * change, 0) + " %)"}});
  if (episode.asked_before >= 0)
    out << "<p>At its onset the correction of episode " << episode.asked_before + 1 << " was still asked for.</p>\n";
  if (!episode.corrections.empty()) {
    html::Table table{{"correction at [s]", "asked for", "answer", "predicted margin", "confidence [%]"}, {}, {}};
    for (const ReportCorrection& correction : episode.corrections)
      table.rows.push_back({shown(correction.time_s, 3), asked_text(correction), answer_to(correction),
                            margin_text(correction),
                            correction.first_sequence == 0 ? "–" : std::to_string(correction.confidence_percent)});
    out << html::table(table);
  }
  if (episode.picture)
    out << html::picture(episode_figure(episode), plot::Format::png,
                         "Vibration, spectrogram, indicator and speed around the onset");
  out << "</div>\n";
}

std::string table_answer(const ReportEpisode& episode) {
  if (!episode.corrections.empty()) return answer_to(episode.corrections.back());
  return episode.asked_before < 0 ? "none" : "still that of " + std::to_string(episode.asked_before + 1);
}

void write_episodes(const Report& report, std::ostream& out) {
  out << "<h2>Chatter</h2>\n";
  if (report.episodes.empty()) out << "<p>None.</p>\n";
  if (report.forced_vibrations > 0)
    out << "<p>Forced vibration, loud at multiples of the spindle's turns and no chatter, was told "
        << report.forced_vibrations << (report.forced_vibrations == 1 ? " time" : " times") << ".</p>\n";
  if (report.episodes.empty()) return;
  std::size_t pictures = 0;
  html::Table table{{"#", "onset [s]", "length [s]", "kind", "frequency [Hz]", "speed [rpm]", "indicator, max",
                     "before", "after", "correction", "end"},
                    {},
                    {}};
  for (const std::size_t i : worst(report.episodes)) {
    const ReportEpisode& episode = report.episodes[i];
    pictures += episode.picture ? 1 : 0;
    table.rows.push_back({std::to_string(i + 1), shown(episode.onset_s, 2), span_text(episode.onset_s, episode.end_s),
                          kind_text(episode.kind), shown(episode.frequency_hz, 0), shown(episode.speed_rpm, 0),
                          shown(episode.indicator, 2), shown(episode.level_before, 1), shown(episode.level_after, 1),
                          table_answer(episode), short_end_of(episode)});
  }
  out << "<div class=\"card\">\n" << html::table(table) << left_out(report.episodes.size(), "episodes");
  out << "<p class=\"soft\">Before: rms vibration in m/s², the loudest 50 ms of the episode. After: the mean of half a "
         "second from 0.1 s "
         "after its end, where the "
         "tool was still in the cut."
      << (pictures < report.episodes.size() ? " Pictures are of the " + std::to_string(pictures) +
                                                  " episodes with the highest indicator; --pictures asks for more."
                                            : std::string{})
      << "</p>\n</div>\n";
  for (std::size_t i = 0; i < report.episodes.size(); ++i)
    if (report.episodes[i].picture) write_episode(report.episodes[i], i, out);
}

void write_lobes(const Report& report, std::ostream& out) {
  out << "<h2>Lobes and cuts</h2>\n<div class=\"card\">\n";
  const std::vector<plot::Figure> figures = lobes_figures(report, kMostReportLobes);
  for (const plot::Figure& figure : figures)
    out << html::picture(figure, plot::Format::svg, "Limit depth over spindle speed with the cuts");
  if (figures.empty())
    out << "<p>No lobes were in use while the tool cut: the cell file's cut or map does not give any, or they were too "
           "old for the posture.</p>\n";
  else
    out << "<p class=\"soft\">A cut without chatter stands at its mean speed and its deepest; chatter at the speed and "
           "depth of its onset. "
        << (report.lobes.size() > figures.size()
                ? "The robot worked at more postures than are drawn: those with the most cuts are."
                : "")
        << "</p>\n";
  out << "</div>\n";
}

void write_health(const Report& report, std::ostream& out) {
  out << "<h2>Health</h2>\n<div class=\"card\">\n";
  out << html::facts({{"CAN frames", std::to_string(report.frames)},
                      {"Lost, by the sensors' counters", std::to_string(report.frames_lost)},
                      {"Bad", std::to_string(report.frames_bad)},
                      {"Dropped, stamp went back", std::to_string(report.frames_out_of_order)},
                      {"Not recorded", std::to_string(report.inputs_lost)}});
  html::Table sensors{{"accelerometer", "samples", "missing", "gaps", "longest [ms]", "saturated", "no number",
                       "rate [Hz]", "measured [Hz]", "error [ppm]"},
                      {},
                      {}};
  for (std::size_t s = 0; s < report.sensors.size(); ++s) {
    const ReportSensor& sensor = report.sensors[s];
    const auto samples = static_cast<double>(sensor.samples);
    const double ppm = 1e6 * (sensor.measured_hz / sensor.sample_rate_hz - 1.0),
                 within = 1e6 * sensor.measured_within_hz / sensor.sample_rate_hz;
    sensors.rows.push_back(
        {std::to_string(s + 1), std::to_string(sensor.samples),
         std::to_string(sensor.missing) + " (" +
             per_cent(static_cast<double>(sensor.missing), samples + static_cast<double>(sensor.missing)) + ")",
         std::to_string(sensor.gaps), shown(1e3 * sensor.longest_gap_s, 1), std::to_string(sensor.saturated),
         std::to_string(sensor.not_finite), shown(sensor.sample_rate_hz, 0), shown(sensor.measured_hz, 1),
         std::isnan(ppm) ? "–" : shown(ppm, 0) + " ± " + shown(within, 0)});
  }
  out << html::table(sensors);
  if (report.faults.empty()) {
    out << "<p>No fault was told.</p>\n</div>\n";
    return;
  }
  html::Table faults{{"fault", "times", "first [s]", "last [s]"}, {}, {}};
  for (const ReportFault& fault : report.faults)
    faults.rows.push_back({fault.what, std::to_string(fault.count), shown(fault.first_s, 2), shown(fault.last_s, 2)});
  out << html::table(faults) << "</div>\n";
}

void write_latency(const Report& report, std::ostream& out) {
  out << "<h2>Latency</h2>\n";
  if (!report.loop_times) {
    out << "<p>This recording holds none: only what <code>stillcutd --record FOLDER</code> writes tells where the live "
           "loop's time went.</p>\n";
    return;
  }
  const LatencyReport& times = *report.loop_times;
  html::Table table{{"stage", "count", "p50 [µs]", "p99 [µs]", "p99.9 [µs]", "max [µs]"}, {}, {}};
  for (const LatencyReport::Stage& stage : times.stages)
    table.rows.push_back({stage.name, std::to_string(stage.count), shown(stage.p50_us, 1), shown(stage.p99_us, 1),
                          shown(stage.p999_us, 1), shown(stage.max_us, 1)});
  out << "<div class=\"card\">\n"
      << html::facts({{"Ticks of 1 ms", std::to_string(times.ticks)},
                      {"Overruns", std::to_string(times.overruns)},
                      {"Skipped", std::to_string(times.skipped)},
                      {"Times out of time", std::to_string(times.times_out)}})
      << html::table(table)
      << "<p class=\"soft\">Of the live run since its start. Decision: from a frame's stamp to the hand-over of what "
         "was decided on it.</p>\n</div>\n";
}

}  // namespace

void write_report_page(const Report& report, std::ostream& out) {
  write_head(report, out);
  write_timeline(report, out);
  write_cuts(report, out);
  write_episodes(report, out);
  write_lobes(report, out);
  write_health(report, out);
  write_latency(report, out);
  out << "<footer>Times are seconds since the first frame. Decided again from the recording by the code of the live "
         "daemon. Terms: "
         "docs/report.md of Stillcut.</footer>\n</main>\n</body>\n</html>\n";
}

}  // namespace stillcut
