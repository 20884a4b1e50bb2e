// report_json of report_page.hpp.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/report_page.hpp"
#include "tools/report_words.hpp"

namespace stillcut {
namespace {

using Json = nlohmann::ordered_json;

// What is not known is null: JSON knows no NaN.
Json known(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json correction_json(const ReportCorrection& correction) {
  return {{"time_s", correction.time_s},
          {"note", correction.note},
          {"mode", mode_text(correction.mode)},
          {"from_rpm", known(correction.from_rpm)},
          {"target_rpm", known(correction.target_rpm)},
          {"predicted_margin_before", known(correction.margin_before)},
          {"predicted_margin_after", known(correction.margin_after)},
          {"confidence_percent", correction.confidence_percent},
          {"accepted", correction.accepted},
          {"refused", correction.refused},
          {"answer", answer_to(correction)}};
}

Json episode_json(const ReportEpisode& episode) {
  Json corrections = Json::array();
  for (const ReportCorrection& correction : episode.corrections) corrections.push_back(correction_json(correction));
  return {{"onset_s", episode.onset_s},
          {"end_s", known(episode.end_s)},
          {"end", end_of(episode)},
          {"came_back_s", known(episode.again_s)},
          {"kind", kind_text(episode.kind)},
          {"frequency_hz", known(episode.frequency_hz)},
          {"indicator_max", known(episode.indicator)},
          {"spindle_speed_rpm", known(episode.speed_rpm)},
          {"axial_depth_mm", known(episode.depth_mm)},
          {"predicted_margin", known(episode.margin)},
          {"level_before_m_per_s2", known(episode.level_before)},
          {"level_after_m_per_s2", known(episode.level_after)},
          {"corrections", corrections}};
}

Json cut_json(const ReportCut& cut) {
  return {{"begin_s", cut.begin_s},
          {"end_s", known(cut.end_s)},
          {"spindle_speed_rpm", known(cut.speed_rpm)},
          {"axial_depth_mm", known(cut.depth_mm)},
          {"indicator_max", known(cut.indicator)},
          {"level_max_m_per_s2", known(cut.level)},
          {"predicted_margin_min", known(cut.margin)},
          {"chatter_s", cut.chatter_s},
          {"episodes", cut.episodes}};
}

Json sensor_json(const ReportSensor& sensor) {
  return {{"samples", sensor.samples},
          {"samples_missing", sensor.missing},
          {"gaps", sensor.gaps},
          {"longest_gap_s", sensor.longest_gap_s},
          {"saturated", sensor.saturated},
          {"not_finite", sensor.not_finite},
          {"sample_rate_hz", sensor.sample_rate_hz},
          {"measured_hz", known(sensor.measured_hz)},
          {"measured_within_hz", known(sensor.measured_within_hz)}};
}

template <class Thing, class ToJson>
Json json_list(const std::vector<Thing>& things, ToJson to_json) {
  Json list = Json::array();
  for (const Thing& thing : things) list.push_back(to_json(thing));
  return list;
}

}  // namespace

nlohmann::ordered_json report_json(const Report& report) {
  static constexpr std::array<const char*, kStates> kNames{"idle", "air",     "entry",       "cut",
                                                           "exit", "chatter", "cannot_tell", "fault"};
  const ReportVerdict verdict = verdict_of(report);
  Json json{{"verdict", verdict.text},
            {"gravity", verdict.gravity == Gravity::good      ? "good"
                        : verdict.gravity == Gravity::notable ? "notable"
                                                              : "bad"},
            {"start_utime", report.origin_ns / 1000},
            {"played_s", report.played_s},
            {"cell", report.cell},
            {"tool", report.tool},
            {"material", report.material},
            {"mode", mode_text(report.mode)},
            {"frames", report.frames},
            {"frames_lost", report.frames_lost},
            {"frames_bad", report.frames_bad},
            {"frames_out_of_order", report.frames_out_of_order},
            {"inputs_not_recorded", report.inputs_lost}};
  for (std::size_t s = 0; s < kNames.size(); ++s) json["time_s"][kNames[s]] = report.state_s[s];
  json["forced_vibrations"] = report.forced_vibrations;
  json["cuts"] = json_list(report.cuts, cut_json);
  json["episodes"] = json_list(report.episodes, episode_json);
  json["sensors"] = json_list(report.sensors, sensor_json);
  json["faults"] = json_list(report.faults, [](const ReportFault& fault) {
    return Json{{"what", fault.what}, {"count", fault.count}, {"first_s", fault.first_s}, {"last_s", fault.last_s}};
  });
  json["latency_us"] = nullptr;
  if (!report.loop_times) return json;
  json["latency_us"] = Json::object();
  for (const LatencyReport::Stage& stage : report.loop_times->stages)
    json["latency_us"][stage.name] = {{"count", stage.count},
                                      {"p50", stage.p50_us},
                                      {"p99", stage.p99_us},
                                      {"p99.9", stage.p999_us},
                                      {"max", stage.max_us}};
  return json;
}

}  // namespace stillcut
