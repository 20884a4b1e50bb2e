// What the daemon has decided: corrections and events, and the words that all panels share.
#include "tools/top_panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numbers>
#include <utility>

#include "tools/spoken.hpp"

namespace stillcut {
namespace {

TextLine correction_line(const Correction& correction) {
  const Ink ink = correction.kind == CorrectionKind::release        ? Ink::plain
                  : correction.kind == CorrectionKind::stop_request ? Ink::alarm
                                                                    : Ink::advice;
  std::string more = printf_text("; %s, %d %% sure", mode_name(correction.mode), correction.confidence_percent);
  if (correction.kind != CorrectionKind::feed_override)
    more += printf_text(", feed %.0f %%", 100.0 * correction.feed_override);
  if (std::isfinite(correction.predicted_margin_before) || std::isfinite(correction.predicted_margin_after))
    more += ", margin " + number_text("%+.2f", correction.predicted_margin_before) + " to " +
            number_text("%+.2f", correction.predicted_margin_after);
  return {{Ink::faint, clock_text(correction.stamp_ns) + " "},
          {ink, asked_text(correction)},
          {Ink::caution, limits_text(correction.limited_by)},
          {Ink::plain, more + "; " + printable(text_of(correction.reason))}};
}

const char* event_words(EventType type) {
  static constexpr std::array kWords{"?",           "cut entry",  "cut exit", "chatter onset",
                                     "chatter end", "correction", "fault",    "forced vibration"};
  return kWords[static_cast<std::size_t>(type) % kWords.size()];
}

TextLine event_row(const Event& event) {
  const bool chatter = event.type == EventType::chatter_onset || event.type == EventType::chatter_end;
  const Ink ink = event.type == EventType::chatter_onset || event.type == EventType::fault ? Ink::alarm : Ink::plain;
  std::string what = event_words(event.type);
  if (chatter && event.kind != ChatterKind::unknown) what += std::string(" (") + chatter_name(event.kind) + ")";
  std::string more;
  if (std::isfinite(event.frequency_hz) && event.frequency_hz > 0.0)
    more += printf_text(", %.1f Hz", event.frequency_hz);
  if (std::isfinite(event.indicator) && event.indicator > 0.0) more += printf_text(", indicator %.2f", event.indicator);
  if (std::isfinite(event.spindle_speed_rpm)) more += printf_text(", %.0f rpm", event.spindle_speed_rpm);
  const std::string note = printable(text_of(event.note));
  return {{Ink::faint, clock_text(event.stamp_ns) + " "},
          {ink, what},
          {Ink::plain, more + (note.empty() ? "" : "; " + note)}};
}

template <class Items, class Draw>
TopPanel list_panel(std::string title, const Items& items, int columns, Draw draw) {
  constexpr int kBelowTheTime = 13;  // columns, of what goes on below
  TopPanel panel{std::move(title), {}, 2, {}};
  for (auto item = items.rbegin(); item != items.rend(); ++item)
    for (TextLine& line : wrapped(draw(*item), columns, kBelowTheTime)) panel.lines.push_back(std::move(line));
  return panel.lines.empty() ? empty_panel(panel.title, "none was heard yet") : panel;
}

}  // namespace

std::string number_text(const char* format, double value, const char* otherwise) {
  return std::isfinite(value) ? printf_text(format, value) : otherwise;
}

std::string clock_text(std::int64_t stamp_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::time_t seconds = stamp_ns / kSecond;
  std::tm at{};
  std::array<char, 16> text{};
  if (localtime_r(&seconds, &at) == nullptr || std::strftime(text.data(), text.size(), "%H:%M:%S", &at) == 0)
    return "--:--:--";
  return text.data() + printf_text(".%03d", static_cast<int>(std::abs(stamp_ns % kSecond) / 1'000'000));
}

std::string list_of(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::string asked_text(const Correction& correction) {
  switch (correction.kind) {
    case CorrectionKind::release:
      return "release to nominal";
    case CorrectionKind::spindle_speed:
      return printf_text("%.0f rpm", correction.spindle_speed_target_rpm);
    case CorrectionKind::speed_variation:
      return printf_text("speed variation of %.1f %% at %.2f Hz", 100.0 * correction.speed_variation_ratio,
                         correction.speed_variation_hz);
    case CorrectionKind::feed_direction:
      return printf_text("feed direction %.1f°", correction.feed_direction * 180.0 / std::numbers::pi);
    case CorrectionKind::feed_override:
      return printf_text("feed override %.0f %%", 100.0 * correction.feed_override);
    case CorrectionKind::stop_request:
      return "stop";
  }
  return "unknown";
}

std::string limits_text(std::int32_t limited_by) {
  const auto names = limits_reached(limited_by);
  return names.empty() ? std::string{} : "; limited by: " + list_of(names);
}

TopPanel empty_panel(std::string title, const char* why) { return {std::move(title), {{{Ink::faint, why}}}, 1, {}}; }

TopPanel corrections_panel(const CellView& view, int columns) {
  return list_panel("Corrections, newest first", view.corrections(), columns, correction_line);
}

TopPanel events_panel(const CellView& view, int columns) {
  return list_panel("Events, newest first", view.events(), columns, event_row);
}

}  // namespace stillcut
