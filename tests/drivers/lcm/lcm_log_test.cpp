#include "drivers/lcm/lcm_log.hpp"

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <sstream>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"
#include "tests/drivers/lcm/random_messages.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kStartUs = 1'700'000'000'000'000;

// Written by LCM itself, as lcm-logger does.
void write_log(const std::filesystem::path& file, const std::vector<std::pair<std::string, MessageBytes>>& messages) {
  lcm::LogFile log(file.string(), "w");
  ASSERT_TRUE(log.good());
  for (std::size_t i = 0; i < messages.size(); ++i) {
    MessageBytes data = messages[i].second;
    lcm::LogEvent event;
    event.eventnum = static_cast<std::int64_t>(i);
    event.timestamp = kStartUs + static_cast<std::int64_t>(i) * 1000;
    event.channel = messages[i].first;
    event.datalen = static_cast<std::int32_t>(data.size());
    event.data = data.data();
    log.writeEvent(&event);
  }
}

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return (std::ostringstream() << in.rdbuf()).str();
}

// Ten robot states, each between an event of a channel that does not concern us and an acknowledgement.
class LcmLog : public testing::Test {
 protected:
  void SetUp() override {
    RandomMessages random(7);
    std::vector<std::pair<std::string, MessageBytes>> messages;
    for (int i = 0; i < 10; ++i) {
      states_.push_back(random.state());
      acks_.push_back(random.ack());
      messages.emplace_back("CAMERA", MessageBytes(1000 + 37 * i, std::uint8_t{0xED}));
      messages.emplace_back("ROBOT_STATE", encode(states_.back()));
      messages.emplace_back("ROBOT_ACK", encode(acks_.back(), "ok"));
    }
    write_log(folder_.path() / "good.log", messages);
    bytes_ = read_bytes(folder_.path() / "good.log");
  }

  LcmLogReader open(const std::string& bytes) { return LcmLogReader(folder_.write("test.log", bytes)); }
  std::string open_error(const std::string& bytes) {
    return message_of<InputError>([&] { open(bytes); });
  }
  static std::vector<RobotMessage> read_all(LcmLogReader& reader) {
    std::vector<RobotMessage> messages;
    while (const auto message = reader.next()) messages.push_back(*message);
    return messages;
  }
  // Where event number `index` begins.
  [[nodiscard]] std::size_t event_at(std::size_t index) const {
    std::size_t at = 0;
    for (; index > 0; --index) at = bytes_.find("\xED\xA1\xDA\x01", at + 1);
    return at;
  }

  TempFolder folder_;
  std::vector<RobotState> states_;
  std::vector<CorrectionAck> acks_;
  std::string bytes_;
};

TEST_F(LcmLog, YieldsTheRobotsMessagesAtTheirEventTimes) {
  LcmLogReader reader = open(bytes_);
  for (std::size_t i = 0; i < states_.size(); ++i) {
    auto state = reader.next();
    auto ack = reader.next();
    ASSERT_TRUE(state && std::holds_alternative<RobotState>(*state));
    ASSERT_TRUE(ack && std::holds_alternative<CorrectionAck>(*ack));
    const auto event = static_cast<std::int64_t>(3 * i + 1);
    EXPECT_EQ(std::get<RobotState>(*state).stamp_ns, (kStartUs + event * 1000) * 1000);
    EXPECT_EQ(std::get<CorrectionAck>(*ack).stamp_ns, (kStartUs + (event + 1) * 1000) * 1000);
    std::get<RobotState>(*state).stamp_ns = states_[i].stamp_ns;
    std::get<CorrectionAck>(*ack).stamp_ns = acks_[i].stamp_ns;
    EXPECT_EQ(encode(std::get<RobotState>(*state)), encode(states_[i]));
    EXPECT_EQ(encode(std::get<CorrectionAck>(*ack)), encode(acks_[i]));
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.events(), 30);
  EXPECT_EQ(reader.bad(), 0);
}

TEST_F(LcmLog, CountsALastEventCutShortAtAnyByte) {
  const std::size_t last = event_at(29);
  for (std::size_t length = last; length < bytes_.size(); ++length) {
    LcmLogReader reader = open(bytes_.substr(0, length));
    EXPECT_EQ(read_all(reader).size(), 19U) << length;
    EXPECT_EQ(reader.bad(), length == last ? 0 : 1) << length;
  }
}

TEST_F(LcmLog, GoesOnBehindADamagedPart) {
  std::string garbage = bytes_;
  garbage.insert(event_at(12), "some bytes that belong to nothing \xED\xA1\xDA");
  LcmLogReader reader = open(garbage);
  // The event before the garbage cannot be told from one with a wrong length: it was the acknowledgement of the fourth
  // state.
  EXPECT_EQ(read_all(reader).size(), 19U);
  EXPECT_EQ(reader.bad(), 1);
}

TEST_F(LcmLog, LosesNothingBehindAWrongLength) {
  std::string wrong_length = bytes_;
  wrong_length[event_at(12) + 26] = '\x7F';  // data length of a CAMERA event: far behind the file's end, or into others
  LcmLogReader reader = open(wrong_length);
  EXPECT_EQ(read_all(reader).size(), 20U);
  EXPECT_EQ(reader.events(), 29);
  EXPECT_EQ(reader.bad(), 1);
}

TEST_F(LcmLog, CountsMessagesThatCannotBeTrusted) {
  RobotState state;
  state.spindle_speed_rpm = -1;
  write_log(folder_.path() / "bad.log", {{"ROBOT_STATE", encode(state)},
                                         {"ROBOT_STATE", encode(CorrectionAck{})},
                                         {"ROBOT_ACK", {}},
                                         {"ROBOT_ACK", encode(CorrectionAck{})}});
  LcmLogReader reader(folder_.path() / "bad.log");
  EXPECT_EQ(read_all(reader).size(), 1U);
  EXPECT_EQ(reader.events(), 4);
  EXPECT_EQ(reader.bad(), 3);
}

TEST_F(LcmLog, YieldsTheAnnouncedPathAtItsEventTimeAndCountsABadOne) {
  RandomMessages random(9);
  RobotPath path = random.path();
  while (path.count < 2) path = random.path();
  RobotPath bad = path;
  bad.points[1].after = -1.0;
  write_log(folder_.path() / "path.log", {{"ROBOT_STATE", encode(random.state())},
                                          {"ROBOT_PATH", encode(bad)},
                                          {"ROBOT_PATH", encode(path)},
                                          {"ROBOT_PATH", encode(RobotPath{})}});
  LcmLogReader reader(folder_.path() / "path.log");
  std::vector<RobotMessage> messages = read_all(reader);
  ASSERT_EQ(messages.size(), 3U);
  ASSERT_TRUE(std::holds_alternative<RobotPath>(messages[1]) && std::holds_alternative<RobotPath>(messages[2]));
  RobotPath& read = std::get<RobotPath>(messages[1]);
  EXPECT_EQ(read.stamp_ns, (kStartUs + 2000) * 1000);
  read.stamp_ns = path.stamp_ns;
  EXPECT_EQ(encode(read), encode(path));
  EXPECT_EQ(std::get<RobotPath>(messages[2]).count, 0U);
  EXPECT_EQ(reader.bad(), 1);
}

TEST_F(LcmLog, RefusesAFileWithoutAWholeEvent) {
  const std::string expected =
      (folder_.path() / "test.log").string() + ": holds no LCM event; name a log of lcm-logger";
  EXPECT_EQ(open_error(""), expected);
  EXPECT_EQ(open_error("(1.000000) can0 123#00\n"), expected);
  EXPECT_EQ(open_error(bytes_.substr(0, 27)), expected);
  EXPECT_EQ(open_error(std::string(200000, '\xED')), expected);
}

TEST_F(LcmLog, RefusesAMissingFileAndAFolder) {
  EXPECT_THROW(LcmLogReader(folder_.path() / "absent.log"), InputError);
  EXPECT_THROW(LcmLogReader(folder_.path()), InputError);
  EXPECT_THROW(LcmLogReader("/dev/zero"), InputError);
}

TEST_F(LcmLog, SurvivesAnyDamage) {
  std::mt19937 damage(8);
  std::int64_t bad = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bytes = bytes_;
    for (int change = 0; change < 20; ++change) bytes[damage() % bytes.size()] = static_cast<char>(damage());
    const auto file = folder_.write("test.log", bytes);
    try {
      LcmLogReader reader(file);
      EXPECT_LE(read_all(reader).size(), 20U);
      bad += reader.bad();
    } catch (const InputError&) {
      ++bad;
    }
  }
  EXPECT_GT(bad, 100);
}

}  // namespace
}  // namespace stillcut
