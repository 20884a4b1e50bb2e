// The readings of `stillcut top`: what is always shown, a row each.
#include <algorithm>
#include <cmath>

#include "tools/top_panels.hpp"

namespace stillcut {
namespace {

constexpr int kReadingName = 11;  // columns

TextLine reading(const char* name, Ink ink, const std::string& text) {
  return {{Ink::faint, padded(name, kReadingName)}, {ink, text}};
}

TextLine advice_line(const CellView& view) {
  const Correction* asked = view.asked();
  if (asked == nullptr) return reading("advised", Ink::plain, "nothing, the program's own settings hold");
  const bool active = asked->mode == RuntimeMode::active;
  return reading("advised", Ink::advice,
                 asked_text(*asked) + (active ? "" : " (shadow: shown, not followed)") +
                     limits_text(asked->limited_by) + " - " + printable(text_of(asked->reason)));
}

TextLine speed_line(const CellView& view, const TopScene& scene, double rpm, int columns) {
  TextLine line = reading("spindle", Ink::strong, padded(number_text("%.0f rpm", rpm), 11));
  double low = scene.min_rpm, high = scene.max_rpm;
  if (!(high > low) && view.diagram()) {
    low = view.diagram()->min_rpm;
    high = view.diagram()->max_rpm;
  }
  if (!(high > low)) return line;
  std::vector<ScaleMark> marks;
  if (const Correction* asked = view.asked(); asked != nullptr && asked->spindle_speed_target_rpm > 0.0)
    marks.push_back({asked->spindle_speed_target_rpm, 'A', Ink::advice});
  marks.push_back({rpm, 'X', Ink::strong});
  const std::string left = printf_text("  %.0f ", low), right = printf_text(" %.0f", high);
  const int room = columns - width_of(line) - width_of(left) - width_of(right);
  if (room < 8) return line;
  line.push_back({Ink::faint, left});
  for (TextPiece& piece : scale_line(low, high, marks, std::min(room, 60))) line.push_back(std::move(piece));
  line.push_back({Ink::faint, right});
  return line;
}

TextLine indicator_line(double indicator, int columns) {
  const Ink ink = indicator >= 1.0 ? Ink::alarm : indicator >= 0.5 ? Ink::caution : Ink::plain;
  TextLine line = reading("indicator", ink, padded(number_text("%.2f", indicator), 11));
  line.push_back({Ink::faint, "  0 "});
  const std::string right = " 2, alarm limit 1";
  const int room = columns - width_of(line) - width_of(right);
  if (room < 8) return line;
  for (TextPiece& piece : scale_line(0.0, 2.0, {{1.0, '|', Ink::plain}, {indicator, '#', ink}}, std::min(room, 60)))
    line.push_back(std::move(piece));
  line.push_back({Ink::faint, right});
  return line;
}

std::string margin_text(const MonitorReport& monitor) {
  const double limit_mm = 1e3 * monitor.depth_limit;
  std::string text = number_text("%+.2f", monitor.margin);
  text += "; depth " + number_text("%.2f mm", 1e3 * monitor.axial_depth);
  text += ", limit " + number_text("%.2f mm", limit_mm, limit_mm > 0.0 ? "none at this speed" : "unknown");
  if (std::isfinite(monitor.predicted_chatter_hz))
    text += printf_text(", chatter expected at %.1f Hz", monitor.predicted_chatter_hz);
  return text;
}

}  // namespace

TextLine scale_line(double low, double high, const std::vector<ScaleMark>& marks, int columns) {
  TextLine line{{Ink::faint, "["}};
  const int inside = std::max(1, columns - 2);
  std::vector<const ScaleMark*> at(static_cast<std::size_t>(inside), nullptr);
  for (const ScaleMark& mark : marks) {
    if (std::isnan(mark.value)) continue;
    const double share = std::clamp((mark.value - low) / (high - low), 0.0, 1.0);
    at[static_cast<std::size_t>(std::lround(share * (inside - 1)))] = &mark;
  }
  for (const ScaleMark* mark : at) {
    const TextPiece piece =
        mark != nullptr ? TextPiece{mark->ink, std::string(1, mark->mark)} : TextPiece{Ink::faint, "-"};
    if (line.back().ink == piece.ink && mark == nullptr)
      line.back().text += piece.text;
    else
      line.push_back(piece);
  }
  line.push_back({Ink::faint, "]"});
  return line;
}

std::vector<TextLine> reading_lines(const CellView& view, const TopScene& scene, int columns) {
  if (!view.monitor()) return {};
  const MonitorReport& monitor = *view.monitor();
  std::vector<TextLine> lines{speed_line(view, scene, monitor.spindle_speed_rpm, columns), advice_line(view)};
  lines.push_back(monitor.chatter ? reading("chatter", Ink::alarm, chatter_sentence(monitor))
                                  : reading("chatter", Ink::plain, "none"));
  if (std::isfinite(monitor.structural_frequency_hz))
    lines.back().push_back(
        {Ink::alarm, printf_text("; the robot's structure at %.1f Hz", monitor.structural_frequency_hz)});
  lines.push_back(indicator_line(monitor.indicator, columns));
  lines.push_back(reading("margin", monitor.margin < 0.0 ? Ink::caution : Ink::plain, margin_text(monitor)));
  return lines;
}

}  // namespace stillcut
