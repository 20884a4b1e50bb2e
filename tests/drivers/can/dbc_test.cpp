#include "drivers/can/dbc.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/files/input_error.hpp"
#include "rt/can_frame.hpp"
#include "tests/drivers/can/temporary_file.hpp"

namespace stillcut {
namespace {

std::string error_of(const std::string& text) {
  return message_of<InputError>([&] { parse_dbc(text, "cell.dbc"); });
}

TEST(Dbc, ReadsMessagesAndSignals) {
  const Dbc dbc = read_dbc(TEST_DATA "/triaxial.dbc");
  EXPECT_THAT(dbc.warnings, testing::IsEmpty());
  const DbcMessage* vibration = dbc.find("Vibration");
  ASSERT_NE(vibration, nullptr);
  EXPECT_EQ(vibration->id, 288U);
  EXPECT_EQ(vibration->length, 64);
  EXPECT_TRUE(vibration->fd);
  EXPECT_EQ(vibration->signals.size(), 33U);
  EXPECT_EQ(vibration->comment, "Ten samples of each axis,\noldest first; \"Count\" says how many are valid.");
  const DbcSignal* x1 = vibration->find("X1");
  ASSERT_NE(x1, nullptr);
  EXPECT_EQ(x1->bits.start, 80);
  EXPECT_EQ(x1->bits.length, 16);
  EXPECT_TRUE(x1->bits.little_endian);
  EXPECT_EQ(x1->type, ValueType::signed_integer);
  EXPECT_EQ(x1->factor, 0.0047884);
  EXPECT_EQ(x1->unit, "m/s^2");
  EXPECT_EQ(x1->line, 21);

  const DbcMessage* spindle = dbc.find("Spindle");
  ASSERT_NE(spindle, nullptr);
  EXPECT_EQ(spindle->id, 0x18FEF100U | CanFrame::kExtended);
  EXPECT_FALSE(spindle->fd);
  const DbcSignal* speed = spindle->find("Speed");
  ASSERT_NE(speed, nullptr);
  EXPECT_FALSE(speed->bits.little_endian);
  EXPECT_EQ(speed->type, ValueType::signed_integer);
  EXPECT_EQ(speed->maximum, 60000.0);
  EXPECT_EQ(speed->comment, "Measured, not commanded");
  EXPECT_EQ(spindle->find("Load")->offset, -100.0);
}

TEST(Dbc, ReadsMultiplexingFloatsValueNamesAndCycleTime) {
  const Dbc dbc = read_dbc(TEST_DATA "/triaxial.dbc");
  const DbcMessage* status = dbc.find("Status");
  ASSERT_NE(status, nullptr);
  EXPECT_EQ(status->cycle_time_ms, 100);
  EXPECT_TRUE(status->find("Page")->multiplexer);
  EXPECT_EQ(status->find("Page")->multiplexed, -1);
  EXPECT_EQ(status->find("Rate")->multiplexed, 0);
  EXPECT_EQ(status->find("Rate")->factor, 0.001);
  EXPECT_EQ(status->find("Temperature")->multiplexed, 1);
  EXPECT_EQ(status->find("Temperature")->type, ValueType::float32);
  EXPECT_THAT(status->find("Page")->value_names,
              testing::ElementsAre(testing::Pair(0, "rate"), testing::Pair(1, "health")));
}

TEST(Dbc, BearsCarriageReturnsAndNamesUnknownStatements) {
  const Dbc dbc =
      parse_dbc("VERSION \"\"\r\nBO_ 1 A: 2 N\r\n SG_ B : 0|8@1+ (1,0) [0|0] \"\" N\r\n\r\nNEWS_ 1;\r\n", "cell.dbc");
  ASSERT_NE(dbc.find("A"), nullptr);
  EXPECT_NE(dbc.find("A")->find("B"), nullptr);
  EXPECT_THAT(dbc.warnings, testing::ElementsAre("cell.dbc:5: 'NEWS_' is not known and passed over"));
}

struct BadDbc {
  const char* text;
  const char* error;
};

class DbcRefuses : public testing::TestWithParam<BadDbc> {};

TEST_P(DbcRefuses, WithFileLineAndReason) { EXPECT_EQ(error_of(GetParam().text), GetParam().error); }

#define A "BO_ 1 A: 2 N\n"
INSTANTIATE_TEST_SUITE_P(
    Lines, DbcRefuses,
    testing::Values(
        BadDbc{"", "cell.dbc: no message (BO_) in this file; is it a DBC file?"},
        BadDbc{"\nBO_ x A: 8 N\n", "cell.dbc:2: whole number expected: message identifier"},
        BadDbc{"BO_ 1 A 8 N\n", "cell.dbc:1: ':' expected before '8 N'"},
        BadDbc{"BO_ 1 A:\n", "cell.dbc:1: whole number expected: message length in bytes"},
        BadDbc{"BO_ 2048 A: 8 N\n",
               "cell.dbc:1: message identifier 2048 is neither 11 bits nor, with bit 31 set, 29 bits wide"},
        BadDbc{"BO_ 1 A: 65 N\n", "cell.dbc:1: message 'A' has 65 bytes; a CAN FD frame holds 0 to 64"},
        BadDbc{A "BO_ 1 B: 2 N\n", "cell.dbc:2: message 'B' has the identifier of message 'A' in line 1"},
        BadDbc{A "BO_ 2 A: 2 N\n", "cell.dbc:2: message 'A' has the name of message 'A' in line 1"},
        BadDbc{" SG_ B : 0|8@1+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:1: a signal (SG_) stands before the first message (BO_)"},
        BadDbc{A " SG_ B : 0|8@1 (1,0) [0|0] \"\" N\n", "cell.dbc:2: '+' expected before '(1,0) [0|0] \"\" N'"},
        BadDbc{A " SG_ B : 0|8@2+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:2: signal 'B': byte order is 0 (Motorola) or 1 (Intel)"},
        BadDbc{A " SG_ B : 0|8@1+ (x,0) [0|0] \"\" N\n", "cell.dbc:2: number expected: factor"},
        BadDbc{A " SG_ B : 0|8@1+ (nan,0) [0|0] \"\" N\n", "cell.dbc:2: number expected: factor"},
        BadDbc{A " SG_ B : 0|8@1+ (0,0) [0|0] \"\" N\n",
               "cell.dbc:2: signal 'B': factor 0 leaves nothing of the signal"},
        BadDbc{A " SG_ B : 0|8@1+ (1,0) [0|0] \"open\n SG_ C : 8|8@1+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:2: unit: the closing quote is missing"},
        BadDbc{A " SG_ B : 0|0@1+ (1,0) [0|0] \"\" N\n", "cell.dbc:2: signal 'B' is 0 bits long; 1 to 64 are possible"},
        BadDbc{A " SG_ B : 0|65@1+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:2: signal 'B' is 65 bits long; 1 to 64 are possible"},
        BadDbc{A " SG_ B : 9|8@1+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:2: signal 'B' reaches beyond the 2 bytes of message 'A'"},
        BadDbc{A " SG_ B : 8|2@0+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:2: signal 'B' reaches beyond the 2 bytes of message 'A'"},
        BadDbc{A " SG_ B : 512|8@1+ (1,0) [0|0] \"\" N\n", "cell.dbc:2: signal 'B': start bit is 0 to 511"},
        BadDbc{A " SG_ B n1 : 0|8@1+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:2: signal 'B': ':', 'M' or 'm' and a number expected after the name"},
        BadDbc{A " SG_ B : 0|8@1+ (1,0) [0|0] \"\" N\n SG_ B : 8|8@1+ (1,0) [0|0] \"\" N\n",
               "cell.dbc:3: signal 'B' is already in line 2"},
        BadDbc{A " SG_ B : 0|8@1+ (1,0) [0|0] \"\" N\nSIG_VALTYPE_ 1 B : 1;\n",
               "cell.dbc:3: signal 'B' is 8 bits long; a float has 32"},
        BadDbc{A "CM_ BO_ 1 \"never\nclosed\n", "cell.dbc:2: comment: the closing quote is missing"},
        BadDbc{A "CM_ BO_ 1 \"open\n SG_ B : 0|8@1+ (1,0) [0|0] \"m\" N\n",
               "cell.dbc:2: ';' expected before 'm\" N'"}));
#undef A

TEST(Dbc, RefusesFilesThatCannotBeRead) {
  EXPECT_EQ(message_of<InputError>([] { read_dbc("/nowhere/x.dbc"); }),
            "/nowhere/x.dbc: cannot be opened: No such file or directory");
  EXPECT_EQ(message_of<InputError>([] { read_dbc("/tmp"); }), "/tmp: is a folder, not a DBC file");
}

}  // namespace
}  // namespace stillcut
