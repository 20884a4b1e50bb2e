// The announced path as a message: lists of a length that the sender states.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "drivers/lcm/messages.hpp"
#include "dsp/numbers.hpp"
#include "tests/drivers/lcm/random_messages.hpp"

namespace stillcut {
namespace {

// Two points, the second a second later.
RobotPath short_path() {
  RobotPath path;
  path.stamp_ns = 5'000'007'000;
  path.count = 2;
  path.points[0].after = 0.5;
  path.points[1].after = 1.5;
  path.points[1].joint_position[5] = 0.25;
  path.points[1].tcp_position[2] = -0.5;
  path.points[1].feed_direction = 0.75;
  path.points[0].radial_depth = 0.125;
  path.points[1].radial_depth = kNaN;
  path.points[1].milling = Milling::slot;
  return path;
}

void set_count(MessageBytes& bytes, std::uint32_t count) {
  for (std::size_t i = 0; i < 4; ++i) bytes[16 + i] = static_cast<std::uint8_t>(count >> (24 - 8 * i));
}

TEST(RobotPathMessage, PutsFieldsWhereTheContractHasThem) {
  const MessageBytes bytes = encode(short_path());
  ASSERT_EQ(bytes.size(), 8U + 8 + 4 + 2 * (8 * (1 + 6 + 3 + 1 + 1) + 1));
  EXPECT_EQ(bytes[19], 2);
  const auto number_at = [&](std::size_t index) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < 8; ++i) value = value << 8 | bytes[20 + 8 * index + i];
    return std::bit_cast<double>(value);
  };
  EXPECT_EQ(number_at(0), 0.5);  // after_s
  EXPECT_EQ(number_at(1), 1.5);
  EXPECT_EQ(number_at(2 + 2 * 6 - 1), 0.25);          // joint_position_rad
  EXPECT_EQ(number_at(2 + 2 * 6 + 2 * 3 - 1), -0.5);  // tcp_position_m
  EXPECT_EQ(number_at(20 + 1), 0.75);                 // feed_direction_rad
  EXPECT_EQ(number_at(22), 0.125);                    // radial_depth_m
  EXPECT_TRUE(std::isnan(number_at(23)));
  EXPECT_EQ(bytes[20 + 24 * 8 + 1], 3);  // milling
}

TEST(RobotPathMessage, TakesTheStampOfReceipt) {
  const auto decoded = decode_robot_path(encode(short_path()), 42'000);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded.value.stamp_ns, 42'000);
  EXPECT_EQ(decoded.value.count, 2U);
  EXPECT_TRUE(std::isnan(decoded.value.points[1].radial_depth));
}

TEST(RobotPathMessage, OneWithoutPointsIsGood) {
  const auto decoded = decode_robot_path(encode(RobotPath{}), 1);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded.value.count, 0U);
}

TEST(RobotPathMessage, RefusesWhatNoMachineSends) {
  const auto why_not = [](auto change) {
    RobotPath path = short_path();
    change(path);
    const auto decoded = decode_robot_path(encode(path), 0);
    return std::string(decoded.ok() ? "" : decoded.why_not);
  };
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(why_not([](RobotPath&) {}), "");
  for (const double bad : {kNaN, kInf, -kInf, 1e30}) {
    for (const std::size_t i : {0U, 1U}) {
      EXPECT_TRUE(why_not([&](RobotPath& p) { p.points[i].after = bad; }).starts_with("after_s"));
      EXPECT_TRUE(why_not([&](RobotPath& p) { p.points[i].joint_position[3] = bad; }).starts_with("joint_position"));
      EXPECT_TRUE(why_not([&](RobotPath& p) { p.points[i].tcp_position[1] = bad; }).starts_with("tcp_position_m"));
      EXPECT_TRUE(why_not([&](RobotPath& p) { p.points[i].feed_direction = bad; }).starts_with("feed_direction"));
    }
  }
  EXPECT_TRUE(why_not([](RobotPath& p) { p.points[0].after = 2.0; }).starts_with("after_s does not rise"));
  EXPECT_TRUE(why_not([](RobotPath& p) { p.points[0].after = -0.1; }).starts_with("after_s"));
  for (const double bad : {kInf, -0.001, 2.0})
    EXPECT_TRUE(why_not([&](RobotPath& p) { p.points[1].radial_depth = bad; }).starts_with("radial_depth_m"));
  for (const int bad : {4, -1})
    EXPECT_TRUE(why_not([&](RobotPath& p) { p.points[1].milling = static_cast<Milling>(bad); }).starts_with("milling"));
}

// The generated code would make room for as many points as the message says before it looks whether they are there.
TEST(RobotPathMessage, ACountThatDoesNotFitIsRefusedBeforeAnyRoomIsMadeForIt) {
  for (const std::uint32_t count : {0U, 1U, 3U, 8U, 9U, 0xFFFFU, 0x10000000U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
    MessageBytes bytes = encode(short_path());
    set_count(bytes, count);
    EXPECT_FALSE(decode_robot_path(bytes, 0).ok()) << count;
    MessageBytes head(bytes.begin(), bytes.begin() + 20);
    EXPECT_EQ(decode_robot_path(head, 0).ok(), count == 0) << count;
  }
  // Nine points with all their bytes: one more than there may be.
  MessageBytes nine(20 + 9 * 97, std::uint8_t{0});
  const MessageBytes good = encode(RobotPath{});
  std::copy(good.begin(), good.end(), nine.begin());
  set_count(nine, 9);
  EXPECT_FALSE(decode_robot_path(nine, 0).ok());
  set_count(nine, 8);
  nine.resize(20 + 8 * 97);
  EXPECT_TRUE(decode_robot_path(nine, 0).ok());
}

}  // namespace
}  // namespace stillcut
