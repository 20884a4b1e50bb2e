// The pictures of `stillcut top`: spectrum and stability lobes, in columns an eighth of a row fine.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "tools/top_panels.hpp"

namespace stillcut {
namespace {

constexpr int kPlotLabel = 7;  // columns left of the picture
constexpr double kShownDb = 60.0;
constexpr int kPlotLeast = 5;

// Columns of `heights` from 0 to 1, as `rows` rows of `columns` characters.
std::vector<std::string> bars(const std::vector<double>& heights, int rows) {
  static constexpr std::array kEighths{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::vector<std::string> lines(static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row)
    for (const double height : heights) {
      const double eighths = 8.0 * (height * rows - (rows - 1 - row));
      const double shown = std::isnan(eighths) ? 0.0 : std::clamp(eighths, 0.0, 8.0);
      lines[static_cast<std::size_t>(row)] += kEighths[static_cast<std::size_t>(shown)];
    }
  return lines;
}

// Characters over a blank row; what comes later stands above what comes earlier.
class MarkRow {
 public:
  explicit MarkRow(int columns) : text_(static_cast<std::size_t>(std::max(0, columns)), ' ') {}
  void put(double share, char mark) {
    if (share >= 0.0 && share <= 1.0 && !text_.empty())
      text_[static_cast<std::size_t>(std::lround(share * static_cast<double>(text_.size() - 1)))] = mark;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string plot_label(const std::string& text) {
  return std::string(static_cast<std::size_t>(std::max(0, kPlotLabel - 1 - width_of(text))), ' ') + text + ' ';
}

// "0            5000 Hz"
TextLine axis_line(const std::string& low, const std::string& high, int columns) {
  const int gap = columns - width_of(low) - width_of(high);
  return {{Ink::faint,
           std::string(kPlotLabel, ' ') + low + std::string(static_cast<std::size_t>(std::max(1, gap)), ' ') + high}};
}

std::vector<TextLine> labelled(const std::vector<std::string>& rows, const std::string& top, const std::string& bottom,
                               Ink ink) {
  std::vector<TextLine> lines;
  for (std::size_t i = 0; i < rows.size(); ++i)
    lines.push_back({{Ink::faint, plot_label(i == 0 ? top : i + 1 == rows.size() ? bottom : "")}, {ink, rows[i]}});
  return lines;
}

std::vector<TextLine> draw_spectrum(const CellView& view, const SpectrumReport& report, int columns, int rows) {
  const int width = columns - kPlotLabel, bar_rows = rows - 2;
  const std::size_t bins = report.levels.size();
  if (width < 1 || bar_rows < 1 || bins == 0) return {{{Ink::faint, "no room, or no spectrum"}}};
  std::vector<double> levels;  // the largest of those that fall in one column, so that no line is lost
  levels.reserve(static_cast<std::size_t>(width));
  for (int c = 0; c < width; ++c) {
    const auto first = bins * static_cast<std::size_t>(c) / static_cast<std::size_t>(width);
    const auto end = std::max(first + 1, bins * static_cast<std::size_t>(c + 1) / static_cast<std::size_t>(width));
    const auto begin = report.levels.begin();
    const auto highest =
        std::max_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(end));
    levels.push_back(report.low_db + report.step_db * static_cast<double>(*highest));
  }
  const double top_db = 10.0 * std::ceil(*std::max_element(levels.begin(), levels.end()) / 10.0);
  for (double& level : levels) level = std::clamp(1.0 - (top_db - level) / kShownDb, 0.0, 1.0);
  const double highest_hz = static_cast<double>(bins) * report.bin_hz;
  const MonitorReport* monitor = view.monitor() ? &*view.monitor() : nullptr;
  auto lines = labelled(bars(levels, bar_rows), printf_text("%.0f", top_db), printf_text("%.0f", top_db - kShownDb),
                        monitor != nullptr && monitor->chatter ? Ink::alarm : Ink::plain);
  lines.push_back(axis_line("0", printf_text("%.0f Hz", highest_hz), width));
  MarkRow marks{width};
  if (report.spindle_hz > 0.0 && highest_hz > 0.0) {
    const double tooth_hz = report.spindle_hz * std::max(1, report.teeth);
    const int harmonics = static_cast<int>(std::min(1e4, highest_hz / tooth_hz));
    for (int k = 1; k <= harmonics; ++k) marks.put(k * tooth_hz / highest_hz, 'T');
    marks.put(report.spindle_hz / highest_hz, 'S');
  }
  if (monitor != nullptr && monitor->chatter) marks.put(monitor->chatter_frequency_hz / highest_hz, 'C');
  lines.push_back({{Ink::faint, plot_label("marks")}, {Ink::strong, marks.text()}});
  return lines;
}

// The limit at a share of the speed range, the smallest of a column's points; NaN: none.
double limit_between(const DiagramReport& diagram, double low, double high) {
  const double last = static_cast<double>(diagram.depth_limit_mm.size() - 1);
  const auto first = static_cast<std::size_t>(std::floor(std::clamp(low, 0.0, 1.0) * last));
  const auto end = static_cast<std::size_t>(std::ceil(std::clamp(high, 0.0, 1.0) * last));
  double limit = kInfinity;
  for (std::size_t i = first; i <= end; ++i) {
    const double here = static_cast<double>(diagram.depth_limit_mm[i]);
    limit = std::min(limit, std::isnan(here) ? 0.0 : here);  // NaN: unstable at every depth
  }
  return limit;
}

// The depth at the picture's top: above the present one and the lowest limit, and as much of the lobes as that leaves.
double shown_depth_mm(const DiagramReport& diagram, double depth_mm) {
  double lowest = kInfinity, highest = 0.0;
  for (const float limit : diagram.depth_limit_mm) {
    if (!std::isfinite(limit)) continue;
    lowest = std::min(lowest, static_cast<double>(limit));
    highest = std::max(highest, static_cast<double>(limit));
  }
  const double base = std::max(std::isfinite(lowest) ? lowest : 0.0, std::isfinite(depth_mm) ? depth_mm : 0.0);
  return base > 0.0 ? std::max(1.5 * base, std::min(1.05 * highest, 3.0 * base)) : std::max(1.05 * highest, 1.0);
}

std::string modes_text(const DiagramReport& diagram) {
  std::string text;
  for (std::size_t i = 0; i < diagram.mode_hz.size(); ++i)
    text += (text.empty() ? "modes " : ", ") + printf_text("%.1f Hz", static_cast<double>(diagram.mode_hz[i])) +
            printf_text(" (%.1f %%)", 100.0 * static_cast<double>(diagram.mode_damping[i]));
  return text;
}

// Puts a mark into a row of characters that may take several bytes each.
void put_mark(TextLine& line, int column, const char* mark, Ink ink) {
  TextLine marked;
  int at = 0;
  for (const TextPiece& piece : line) {
    const int wide = width_of(piece.text);
    if (column < at || column >= at + wide) {
      marked.push_back(piece);
    } else {
      std::string before, behind;
      int passed = at - 1;
      for (const char byte : piece.text) {
        passed += (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U ? 0 : 1;
        if (passed < column) before += byte;
        if (passed > column) behind += byte;
      }
      marked.push_back({piece.ink, before});
      marked.push_back({ink, mark});
      marked.push_back({piece.ink, behind});
    }
    at += wide;
  }
  line = std::move(marked);
}

std::vector<TextLine> draw_lobes(const CellView& view, const DiagramReport& diagram, int columns, int rows) {
  const int width = columns - kPlotLabel;
  const bool with_modes = rows > kPlotLeast + 1 && !diagram.mode_hz.empty();
  const int bar_rows = rows - 1 - (with_modes ? 1 : 0);
  if (width < 2 || bar_rows < 1 || diagram.depth_limit_mm.size() < 2) return {{{Ink::faint, "no room, or no lobes"}}};
  const MonitorReport* monitor = view.monitor() ? &*view.monitor() : nullptr;
  const double depth_mm = monitor != nullptr ? 1e3 * monitor->axial_depth : kNaN;
  const double top_mm = shown_depth_mm(diagram, depth_mm);
  std::vector<double> heights;
  heights.reserve(static_cast<std::size_t>(width));
  for (int c = 0; c < width; ++c)
    heights.push_back(std::clamp(
        limit_between(diagram, c / static_cast<double>(width), (c + 1) / static_cast<double>(width)) / top_mm, 0.0,
        1.0));
  auto lines = labelled(bars(heights, bar_rows), printf_text("%.3g", top_mm), "0 mm", Ink::good);
  const auto put = [&](double rpm, const char* mark, Ink ink) {
    if (!(diagram.max_rpm > diagram.min_rpm) || !std::isfinite(rpm) || !std::isfinite(depth_mm)) return;
    const double across = std::clamp((rpm - diagram.min_rpm) / (diagram.max_rpm - diagram.min_rpm), 0.0, 1.0);
    const double up = std::clamp(depth_mm / top_mm, 0.0, 1.0);
    const int row = std::clamp(bar_rows - 1 - static_cast<int>(up * bar_rows), 0, bar_rows - 1);
    put_mark(lines[static_cast<std::size_t>(row)], kPlotLabel + static_cast<int>(std::lround(across * (width - 1))),
             mark, ink);
  };
  if (const Correction* asked = view.asked(); asked != nullptr && (asked->kind == CorrectionKind::spindle_speed ||
                                                                   asked->kind == CorrectionKind::feed_override))
    put(asked->spindle_speed_target_rpm, "A", Ink::advice);
  if (monitor != nullptr) put(monitor->spindle_speed_rpm, "X", Ink::strong);
  lines.push_back(axis_line(printf_text("%.0f", diagram.min_rpm), printf_text("%.0f rpm", diagram.max_rpm), width));
  if (with_modes) lines.push_back({{Ink::faint, modes_text(diagram)}});
  return lines;
}

}  // namespace

TopPanel spectrum_panel(const CellView& view, int sensor, int columns) {
  const auto& spectra = view.spectra();
  if (spectra.empty()) return empty_panel("Spectrum", "none was heard yet");
  const int count = static_cast<int>(spectra.size());
  const SpectrumReport& report = std::next(spectra.begin(), (sensor % count + count) % count)->second;
  TopPanel panel{printf_text("Spectrum, accelerometer %d%s, dB re 1 m/s²; S spindle, T %s, C chatter",
                             report.sensor + 1, count > 1 ? " (s: next)" : "", count > 1 ? "teeth" : "tooth passing"),
                 {},
                 kPlotLeast,
                 [&view, &report, columns](int rows) { return draw_spectrum(view, report, columns, rows); }};
  return panel;
}

TopPanel lobes_panel(const CellView& view, int columns) {
  const auto& diagram = view.diagram();
  if (!diagram) return empty_panel("Stability lobes", "none were heard yet");
  if (!diagram->valid || diagram->depth_limit_mm.size() < 2)
    return empty_panel("Stability lobes", "none that suit the present posture");
  return {"Stability lobes, depth in mm; filled: stable, X now, A advised",
          {},
          kPlotLeast,
          [&view, &report = *diagram, columns](int rows) { return draw_lobes(view, report, columns, rows); }};
}

}  // namespace stillcut
