#include "tools/top_screen.hpp"

#include <algorithm>
#include <cmath>

#include "tools/big_letters.hpp"
#include "tools/spoken.hpp"
#include "tools/top_panels.hpp"

namespace stillcut {
namespace {

constexpr int kColumnLeast = 78, kColumnGap = 2;  // of panels side by side
constexpr int kRowsForBigLetters = 16, kRowsForReadings = 10;
constexpr std::size_t kReasonRows = 2;

Ink state_ink(Shown shown) {
  switch (shown) {
    case Shown::stable:
      return Ink::good;
    case Shown::watch:
      return Ink::caution;
    case Shown::chatter:
    case Shown::fault:
      return Ink::alarm;
    case Shown::correcting:
      return Ink::advice;
    case Shown::cannot_tell:
    case Shown::no_daemon:
      return Ink::doubt;
    case Shown::not_cutting:
      break;
  }
  return Ink::strong;
}

TextLine header_line(const CellView& view, const TopScene& scene, int columns) {
  TextLine line{{Ink::strong, printable(scene.title)}};
  if (view.monitor()) line.push_back({Ink::plain, std::string("  mode ") + mode_name(view.monitor()->mode)});
  if (scene.paused) line.push_back({Ink::caution, "  PAUSED, p: go on"});
  const double silent = view.silent_s(scene.now_ns);
  if (silent > 1.0 && std::isfinite(silent))
    line.push_back({Ink::doubt, printf_text("  last heard %.0f s ago", silent)});
  const std::string where = printable(scene.where);
  if (const int gap = columns - width_of(line) - width_of(where); gap >= 2)
    line.push_back({Ink::faint, std::string(static_cast<std::size_t>(gap), ' ') + where});
  return clipped(line, columns);
}

void add_state(std::vector<TextLine>& lines, const ShownState& state, int columns, bool big) {
  const std::string word = shown_name(state.shown);
  const Ink ink = state_ink(state.shown);
  if (big && big_width(word) <= columns) {
    for (const std::string& row : big_letters(word)) lines.push_back({{ink, row}});
    // Also as a word: for those who search the text, and for small fonts.
    lines.push_back({{ink, word}, {Ink::plain, ": "}});
  } else {
    lines.push_back({{ink, clipped(word, columns)}, {Ink::plain, ": "}});
  }
  TextLine& last = lines.back();
  const std::string reason = printable(state.reason);
  if (width_of(last) + width_of(reason) <= columns) {
    last.push_back({Ink::plain, reason});
    return;
  }
  if (width_of(last) > columns) last = clipped(TextLine{{ink, word}}, columns);
  for (const std::string& row : wrapped(reason, columns, kReasonRows)) lines.push_back({{Ink::plain, row}});
}

std::vector<TopPanel> panels_of(const CellView& view, const TopScene& scene, int columns) {
  return {spectrum_panel(view, scene.sensor, columns),
          lobes_panel(view, columns),
          corrections_panel(view, columns),
          events_panel(view, columns),
          sensors_panel(view, columns),
          losses_panel(view, scene.unreadable, columns),
          latency_panel(view),
          spread_panel(view)};
}

// Where a panel stands; `rows` is below its title.
struct PlacedPanel {
  const TopPanel* panel;
  int page, column, rows;
};

// In their order, as many on a page as go there with `comfort` of the rows that they want beyond the least, 0 to 1.
std::vector<PlacedPanel> place(const std::vector<TopPanel>& panels, int across, int rows, double comfort) {
  std::vector<PlacedPanel> placed;
  int page = 0, column = 0, used = 0;
  for (const TopPanel& panel : panels) {
    const int more = std::max(0, panel.wanted() - panel.least);
    const int height = std::min(panel.least, panel.wanted()) + static_cast<int>(comfort * more);
    if (used > 0 && used + 1 + height > rows) {
      used = 0;
      ++column;
    }
    if (column == across) {
      column = 0;
      ++page;
    }
    placed.push_back({&panel, page, column, std::min(height, std::max(0, rows - 1))});
    used += 1 + placed.back().rows;
  }
  return placed;
}

// What is left over in each column goes to those that want more, a row each in turn, then to the pictures.
void fill_columns(std::vector<PlacedPanel>& placed, int rows) {
  for (auto first = placed.begin(); first != placed.end();) {
    const auto end = std::find_if(
        first, placed.end(), [&](const PlacedPanel& p) { return p.page != first->page || p.column != first->column; });
    int left = rows;
    for (auto p = first; p != end; ++p) left -= 1 + p->rows;
    for (const bool beyond_wanted : {false, true})
      for (bool gave = true; gave && left > 0;) {
        gave = false;
        for (auto p = first; p != end && left > 0; ++p) {
          if (beyond_wanted ? !p->panel->picture : p->rows >= p->panel->wanted()) continue;
          ++p->rows;
          --left;
          gave = true;
        }
      }
    first = end;
  }
}

// On one page where that is possible, and then as comfortably as it is.
std::vector<PlacedPanel> place(const std::vector<TopPanel>& panels, int across, int rows) {
  std::vector<PlacedPanel> placed;
  for (const double comfort : {1.0, 0.75, 0.5, 0.25, 0.0}) {
    placed = place(panels, across, rows, comfort);
    if (placed.back().page == 0) break;
  }
  fill_columns(placed, rows);
  return placed;
}

std::vector<TextLine> panel_lines(const TopPanel& panel, int columns, int rows) {
  std::vector<TextLine> lines{clipped(TextLine{{Ink::strong, panel.title}}, columns)};
  if (rows < 1) return lines;
  auto drawn = panel.picture ? panel.picture(rows) : panel.lines;
  if (const int count = static_cast<int>(drawn.size()); count > rows) {
    drawn.resize(static_cast<std::size_t>(rows));
    drawn.back() = {{Ink::faint, printf_text("… %d more rows", count - rows + 1)}};
  }
  for (const TextLine& line : drawn) lines.push_back(clipped(line, columns));
  return lines;
}

// Appends `lines` from row `top` on, beside what stands there up to column `left`.
void put_beside(std::vector<TextLine>& screen, std::size_t top, int left, std::vector<TextLine> lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (screen.size() <= top + i) screen.resize(top + i + 1);
    TextLine& row = screen[top + i];
    if (const int gap = left - width_of(row); gap > 0 && !lines[i].empty())
      row.push_back({Ink::plain, std::string(static_cast<std::size_t>(gap), ' ')});
    for (TextPiece& piece : lines[i]) row.push_back(std::move(piece));
  }
}

TextLine footer_line(const std::vector<PlacedPanel>& placed, int page, int pages, int columns) {
  std::string text = "q quit  ? help  p pause";
  if (pages > 1) {
    text += printf_text("  tab page %d of %d", page + 1, pages);
    std::string others;
    for (const PlacedPanel& p : placed)
      if (p.page == (page + 1) % pages)
        others += (others.empty() ? "" : ", ") + p.panel->title.substr(0, p.panel->title.find(','));
    text += ", next: " + others;
  }
  return clipped(TextLine{{Ink::faint, text}}, columns);
}

std::vector<TextLine> help_lines(int columns) {
  std::vector<TextLine> lines;
  for (const char* row :
       {"q        quit", "p, space pause: the screen stands still, nothing else does",
        "tab      the next page of panels; 1 to 9: that page", "s        the next accelerometer's spectrum",
        "?        this help, and back", "",
        "stable       the indicator is low, and the cut is not deeper than the lobes allow",
        "watch        the indicator is above half the alarm limit, or the cut is too deep for the lobes",
        "chatter      heard; the reason says which kind, at what frequency, near which mode",
        "correcting   the controller is asked to do something about it (mode active only)",
        "cannot tell  what is heard cannot be trusted; the reason says why", "fault        bus, loop or data failed",
        "not cutting  the spindle stands, or the tool turns in air",
        "no daemon    nothing was heard for 1.5 s; start it: stillcutd CELL", "",
        "This only listens: nothing here reaches the daemon. docs/top.md says more."})
    lines.push_back(clipped(TextLine{{Ink::plain, row}}, columns));
  return lines;
}

}  // namespace

TopScreen draw_top(const CellView& view, const TopScene& scene, int columns, int rows) {
  columns = std::max(1, columns);
  const bool whole = rows <= 0;  // as long as it takes
  TopScreen screen;
  auto& lines = screen.lines;
  const ShownState state = view.state(scene.now_ns);
  if (whole || rows > 2) lines.push_back(header_line(view, scene, columns));
  add_state(lines, state, columns, whole || rows >= kRowsForBigLetters);
  if (whole || rows >= kRowsForReadings)
    for (const TextLine& line : reading_lines(view, scene, columns)) lines.push_back(clipped(line, columns));
  if (scene.help && !whole) {
    for (TextLine& line : help_lines(columns)) lines.push_back(std::move(line));
    lines.resize(std::min(lines.size(), static_cast<std::size_t>(rows)));
    return screen;
  }
  const std::size_t top = lines.size();
  const int across = whole ? 1 : std::clamp((columns + kColumnGap) / (kColumnLeast + kColumnGap), 1, 3);
  const int wide = (columns - (across - 1) * kColumnGap) / across;
  const std::vector<TopPanel> panels = panels_of(view, scene, wide);
  int room = rows - static_cast<int>(top) - 1;  // the last row is the footer's
  if (whole) {
    room = 0;
    for (const TopPanel& panel : panels) room += 1 + panel.wanted();
  }
  if (room < 2) {  // no place for panels
    lines.resize(std::min(lines.size(), static_cast<std::size_t>(std::max(1, rows))));
    return screen;
  }
  const auto placed = place(panels, across, room);
  screen.pages = placed.back().page + 1;
  const int page = (scene.page % screen.pages + screen.pages) % screen.pages;
  std::vector<std::size_t> next(static_cast<std::size_t>(across), top);
  for (const PlacedPanel& p : placed) {
    if (p.page != page) continue;
    std::size_t& at = next[static_cast<std::size_t>(p.column)];
    put_beside(lines, at, p.column * (wide + kColumnGap), panel_lines(*p.panel, wide, p.rows));
    at += static_cast<std::size_t>(1 + p.rows);
  }
  if (whole) return screen;
  lines.resize(static_cast<std::size_t>(rows - 1));
  lines.push_back(footer_line(placed, page, screen.pages, columns));
  return screen;
}

}  // namespace stillcut
