#include "tools/cell_stream.hpp"

#include <gtest/gtest.h>

namespace stillcut {
namespace {

Correction asking(std::int64_t sequence, std::int64_t stamp_ns, double target_rpm) {
  Correction correction;
  correction.sequence = sequence;
  correction.stamp_ns = stamp_ns;
  correction.kind = CorrectionKind::spindle_speed;
  correction.spindle_speed_target_rpm = target_rpm;
  return correction;
}

TEST(CellStream, TellsEachCorrectionOnceAlsoOfADaemonThatCountsAnew) {
  constexpr std::int64_t kNow_ns = 1'700'000'000'000'000'000;
  int told = 0;
  CellStream stream{0, [&](const StreamItem& item) { told += item.chunk->starts_with("event: correction") ? 1 : 0; }};
  stream.take(asking(1, kNow_ns, 7567.0), 0);
  stream.take(asking(2, kNow_ns + 50'000'000, 7567.0), 0);  // the next setpoint of the same move
  EXPECT_EQ(told, 1);
  stream.take(asking(1, kNow_ns + 60'000'000'000, 9000.0), 0);
  EXPECT_EQ(told, 2);
}

}  // namespace
}  // namespace stillcut
