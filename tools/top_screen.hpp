// What `stillcut top` shows of a cell, drawn as lines of text: a pure function of what was heard and of the terminal's
// size.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "tools/cell_view.hpp"
#include "tools/styled_text.hpp"

namespace stillcut {

struct TopScene {
  std::string title, where;               // the cell's name, LCM's address
  double min_rpm = kNaN, max_rpm = kNaN;  // of the spindle; NaN: not known
  std::int64_t now_ns = 0;                // on the clock of CellView::take()
  std::int64_t unreadable = 0;            // messages heard that could not be read
  int page = 0;                           // counted from 0; any number, taken modulo the pages there are
  int sensor = 0;                         // whose spectrum; likewise
  bool paused = false, help = false;
};

struct TopScreen {
  std::vector<TextLine> lines;
  int pages = 1;
};

// rows 0: one page, as long as it takes. Otherwise no more lines than `rows`; no line is wider than `columns`. What
// does not fit on a page is on another, which the last line names. The state is on every page.
TopScreen draw_top(const CellView& view, const TopScene& scene, int columns, int rows);

}  // namespace stillcut
