#include "tools/message_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/lcm/telemetry_messages.hpp"
#include "tests/drivers/lcm/random_messages.hpp"
#include "tools/message_json.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Sent = std::pair<const char*, MessageBytes>;

std::vector<Sent> random_round(RandomMessages& random) {
  return {{kRobotStateChannel, encode(random.state())},
          {kRobotPathChannel, encode(random.path())},
          {kRobotAckChannel, encode(random.ack(), "too \"fast\"")},
          {kCorrectionChannel, encode(random.correction())},
          {kEventChannel, encode(random.event())},
          {kStatusChannel, encode(random.status())}};
}

TEST(MessageText, PrintsEveryFieldOfRandomMessagesWithItsMeaning) {
  RandomMessages random{21};
  for (int round = 0; round < 300; ++round)
    for (const auto& [channel, bytes] : random_round(random)) {
      const std::string text = message_text(channel, bytes, 1'700'000'000'000'000, true);
      const MessageReading message = read_message(bytes);
      ASSERT_NE(message.schema, nullptr);
      EXPECT_THAT(text, HasSubstr(std::string(channel) + "  " + message.schema->name));
      std::string_view left = text;
      for (const SchemaField& field : message.schema->fields) {
        const auto at = left.find("\n  " + field.name);
        ASSERT_NE(at, std::string_view::npos) << field.name << " in\n" << text;
        left.remove_prefix(at + 1);
        EXPECT_THAT(std::string(left.substr(0, left.find('\n'))), HasSubstr(field.comment));
      }
      EXPECT_THAT(text, Not(HasSubstr("broken")));
      EXPECT_THAT(text, Not(HasSubstr("refuses"))) << text;
    }
}

// A number that is printed and read again is the same number.
TEST(MessageText, ValuesComeBackAsTheyWere) {
  std::mt19937_64 random{8};
  for (int round = 0; round < 5000; ++round) {
    const auto number = std::bit_cast<double>(random());
    const double back = std::strtod(value_text(number).c_str(), nullptr);
    EXPECT_TRUE(back == number || (std::isnan(back) && std::isnan(number))) << value_text(number);
    const auto narrow = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const float narrow_back = std::strtof(value_text(narrow).c_str(), nullptr);
    EXPECT_TRUE(narrow_back == narrow || (std::isnan(narrow_back) && std::isnan(narrow))) << value_text(narrow);
  }
  EXPECT_EQ(value_text(std::int64_t{-5}), "-5");
}

TEST(MessageText, JsonHoldsEveryFieldInItsShape) {
  RandomMessages random{22};
  for (int round = 0; round < 50; ++round) {
    const RobotPath path = random.path();
    const auto json = nlohmann::json::parse(message_json(kRobotPathChannel, encode(path), 7).dump());
    EXPECT_EQ(json.at("type"), "robot_path_t");
    EXPECT_EQ(json.at("received_utime"), 7);
    EXPECT_TRUE(json.at("why_not").is_null());
    const auto& joints = json.at("fields").at("joint_position_rad");
    ASSERT_EQ(joints.size(), path.count);
    for (std::size_t i = 0; i < path.count; ++i)
      EXPECT_EQ(joints.at(i).get<std::vector<double>>(),
                std::vector<double>(path.points[i].joint_position.begin(), path.points[i].joint_position.end()));
  }
  Status status;
  status.margin = kNaN;
  EXPECT_EQ(message_json(kStatusChannel, encode(status), 0).at("fields").at("margin"), "NaN");
}

TEST(MessageText, SaysWhatIsWrongWithBrokenRefusedAndForeignMessages) {
  RobotState state;
  state.feed_rate = kNaN;
  EXPECT_THAT(message_text(kRobotStateChannel, encode(state), 0, false),
              HasSubstr("! Stillcut refuses it: feed_rate_m_per_s is not a number from 0 to 100"));
  MessageBytes bytes = encode(Status{});
  bytes.resize(bytes.size() - 20);
  const std::string broken = message_text(kStatusChannel, bytes, 0, false);
  EXPECT_THAT(broken, HasSubstr("! broken: the bytes end within frames\n"));
  EXPECT_THAT(broken, HasSubstr("\n  indicator"));
  const MessageBytes foreign(40, 0xAB);
  const std::string other = message_text("OTHER\x1b[2J", foreign, 0, false);
  EXPECT_THAT(other, HasSubstr("OTHER?[2J  fingerprint 0xabababababababab, 40 bytes"));
  EXPECT_THAT(other, HasSubstr("\n  ab ab ab"));
  EXPECT_THAT(message_text("SHORT", {}, 0, false), HasSubstr("shorter than a fingerprint"));
  EXPECT_THAT(message_text(kStatusChannel, encode(Event{}), 0, false), HasSubstr("event_t"))
      << "what it is, not what it should be";
  EXPECT_THAT(message_text(kStatusChannel, encode(Event{}), 0, false), HasSubstr("refuses"));
}

TEST(MessageText, LongArraysSayThatTheyAreCut) {
  SpectrumReport spectrum;
  spectrum.levels.assign(300, 7);
  const MessageBytes bytes = encode(spectrum);
  EXPECT_THAT(message_text(kSpectrumChannel, bytes, 0, false), HasSubstr("… 288 more, see --all"));
  EXPECT_THAT(message_text(kSpectrumChannel, bytes, 0, true), Not(HasSubstr("more")));
}

}  // namespace
}  // namespace stillcut
