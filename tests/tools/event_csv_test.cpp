#include "tools/event_csv.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "dsp/numbers.hpp"
#include "tools/event_tally.hpp"

namespace stillcut {
namespace {

std::string row(const Event& event, std::int64_t origin_ns = 1'500'000'000'000'000'000) {
  std::ostringstream out;
  write_event(out, event, origin_ns);
  return out.str();
}

TEST(EventCsv, RowHasTheSevenColumnsOfTheHeader) {
  std::ostringstream header;
  write_event_header(header);
  EXPECT_EQ(header.str(), "time_s,event,kind,frequency_hz,indicator,spindle_speed_rpm,note\n");
  const Event onset{1'500'000'003'712'500'000, EventType::chatter_onset, ChatterKind::regenerative, 746.25, 1.5, 9000.0,
                    short_text("start=3.612")};
  EXPECT_EQ(row(onset), "3.712500,chatter_onset,regenerative,746.250000,1.500000,9000.000000,start=3.612\n");
}

TEST(EventCsv, NotApplicableIsEmptyAndKindIsOfChatterOnly) {
  const Event entry{1'500'000'000'000'000'000, EventType::cut_entry, ChatterKind::regenerative, kNaN, kNaN, kNaN, {}};
  EXPECT_EQ(row(entry), "0.000000,cut_entry,,,,,\n");
}

TEST(EventCsv, NotesAreQuotedWhereCsvAsksForIt) {
  const Event fault{1'500'000'000'000'000'000, EventType::fault, ChatterKind::unknown, kNaN, kNaN, 0.0,
                    short_text("a, \"b\"")};
  EXPECT_EQ(row(fault), "0.000000,fault,,,,0.000000,\"a, \"\"b\"\"\"\n");
}

TEST(EventCsv, NamesAreThoseOfTheContract) {
  EXPECT_EQ(event_name(EventType::cut_entry), "cut_entry");
  EXPECT_EQ(event_name(EventType::cut_exit), "cut_exit");
  EXPECT_EQ(event_name(EventType::chatter_onset), "chatter_onset");
  EXPECT_EQ(event_name(EventType::chatter_end), "chatter_end");
  EXPECT_EQ(event_name(EventType::forced_vibration), "forced_vibration");
  EXPECT_EQ(event_name(EventType::correction), "correction");
  EXPECT_EQ(event_name(EventType::fault), "fault");
}

TEST(EventTally, AKindToldLaterBelongsToTheSameOnset) {
  EventTally tally;
  const auto count = [&](EventType type, ChatterKind kind) {
    Event event;
    event.type = type;
    event.kind = kind;
    tally.count(event);
  };
  count(EventType::chatter_onset, ChatterKind::unknown);
  count(EventType::chatter_onset, ChatterKind::regenerative);
  count(EventType::correction, ChatterKind::unknown);
  count(EventType::chatter_end, ChatterKind::regenerative);
  count(EventType::chatter_onset, ChatterKind::structural);
  count(EventType::fault, ChatterKind::unknown);
  EXPECT_EQ(tally.chatter_onsets, 2);
  EXPECT_EQ(tally.corrections, 1);
  EXPECT_EQ(tally.faults, 1);
}

}  // namespace
}  // namespace stillcut
