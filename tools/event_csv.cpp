#include "tools/event_csv.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "drivers/files/csv.hpp"

namespace stillcut {
namespace {

double seconds(const Event& event, std::int64_t origin_ns) {
  return static_cast<double>(event.stamp_ns - origin_ns) * 1e-9;
}

bool about_chatter(const Event& event) {
  return event.type == EventType::chatter_onset || event.type == EventType::chatter_end;
}

// Fixed decimals: columns line up, and nine digits are below anything that a decision rests on.
std::string fixed(double value, int decimals) {
  if (std::isnan(value)) return "";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

}  // namespace

std::string_view event_name(EventType type) noexcept {
  switch (type) {
    case EventType::cut_entry:
      return "cut_entry";
    case EventType::cut_exit:
      return "cut_exit";
    case EventType::chatter_onset:
      return "chatter_onset";
    case EventType::chatter_end:
      return "chatter_end";
    case EventType::correction:
      return "correction";
    case EventType::fault:
      return "fault";
    case EventType::forced_vibration:
      return "forced_vibration";
  }
  return "";
}

std::string_view kind_name(const Event& event) noexcept {
  if (!about_chatter(event)) return "";
  switch (event.kind) {
    case ChatterKind::unknown:
      return "unknown";
    case ChatterKind::regenerative:
      return "regenerative";
    case ChatterKind::structural:
      return "structural";
  }
  return "";
}

void write_event_header(std::ostream& out) {
  out << "time_s,event,kind,frequency_hz,indicator,spindle_speed_rpm,note\n";
}

void write_event(std::ostream& out, const Event& event, std::int64_t origin_ns) {
  const std::array<std::string, 7> row = {fixed(seconds(event, origin_ns), 6), std::string(event_name(event.type)),
                                          std::string(kind_name(event)),       fixed(event.frequency_hz, 6),
                                          fixed(event.indicator, 6),           fixed(event.spindle_speed_rpm, 6),
                                          csv_text(event.note.data())};
  write_csv_row(out, row);
}

std::string event_line(const Event& event, std::int64_t origin_ns) {
  std::array<char, 256> text{};
  std::string name{event_name(event.type)};
  for (char& c : name) c = c == '_' ? ' ' : c;
  std::snprintf(text.data(), text.size(), "%9.3f s  %-16s", seconds(event, origin_ns), name.c_str());
  std::string line = text.data();
  if (about_chatter(event)) line.append(" ").append(kind_name(event));
  if (!std::isnan(event.frequency_hz)) line.append(" at ").append(fixed(event.frequency_hz, 1)).append(" Hz");
  if (event.type == EventType::correction && !std::isnan(event.spindle_speed_rpm)) {
    line.append(" -> spindle ").append(fixed(event.spindle_speed_rpm, 0)).append(" rpm");
  }
  if (event.note[0] != 0) line.append("  (").append(event.note.data()).append(")");
  return line;
}

}  // namespace stillcut
