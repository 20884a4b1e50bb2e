#include "adapters/egm_packets.hpp"

#include <egm.pb.h>

#include <cmath>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kLargestEgmPacket = 4096;
constexpr double kEgmMmPerM = 1e3;
constexpr std::uint64_t kLastSecond = 4'000'000'000;  // so that the clock fits in nanoseconds
constexpr double kLargestBlock = 2e9;

// Without the library's own words on standard error for every packet that lacks a field.
template <class Message>
bool parse_quietly(Message& message, const void* bytes, std::size_t size) {
  return message.ParsePartialFromArray(bytes, static_cast<int>(size)) && message.IsInitialized();
}

egm::Header header_of(const AnswerHead& head, egm::Header::Type type) {
  egm::Header header;
  header.set_sequence(head.number);
  header.set_time_ms(head.time_ms);
  header.set_type(type);
  return header;
}

// The controller's own clock; older versions send no time with the feedback, only the header's milliseconds.
std::optional<std::int64_t> clock_us(const egm::Robot& robot) {
  if (!robot.feedback().has_time()) return std::int64_t{robot.header().time_ms()} * 1000;
  const auto& time = robot.feedback().time();
  if (time.seconds() > kLastSecond || time.microseconds() >= 1'000'000) return std::nullopt;
  return static_cast<std::int64_t>(time.seconds() * 1'000'000 + time.microseconds());
}

const char* read_feedback(const egm::Feedback& feedback, ControllerReport& report) {
  if (!feedback.has_pose() || !feedback.pose().has_position()) return "it tells no position";
  const egm::Cartesian& position = feedback.pose().position();
  report.position = {position.x() / kEgmMmPerM, position.y() / kEgmMmPerM, position.z() / kEgmMmPerM};
  if (feedback.pose().has_orientation()) {
    const egm::Quaternion& q = feedback.pose().orientation();
    report.orientation = {q.w(), q.x(), q.y(), q.z()};
  }
  if (!feedback.has_joints()) return nullptr;
  if (feedback.joints().values_size() > static_cast<int>(report.joints.size())) return "it has more than six joints";
  for (int i = 0; i < feedback.joints().values_size(); ++i)
    report.joints[static_cast<std::size_t>(i)] = deg_to_rad(feedback.joints().values(i));
  return nullptr;
}

}  // namespace

ParsedReport parse_egm(std::span<const std::uint8_t> packet) {
  const auto refuse = [](const char* why_not) { return ParsedReport{{}, why_not}; };
  egm::Robot robot;
  if (packet.empty() || packet.size() > kLargestEgmPacket) return refuse("not of a size that EGM sends");
  if (!parse_quietly(robot, packet.data(), packet.size())) return refuse("no EGM packet of a robot");
  if (!robot.has_header() || !robot.header().has_sequence()) return refuse("it has no header with a sequence number");
  if (robot.header().type() != egm::Header::DATA) return refuse("its header says that it comes from no robot");
  if (!robot.has_feedback()) return refuse("it has no feedback");
  ParsedReport parsed;
  ControllerReport& report = parsed.report;
  const auto clock = clock_us(robot);
  if (!clock) return refuse("its time is out of range");
  report.counter = robot.header().sequence();
  report.clock_us = *clock;
  report.block = static_cast<std::int32_t>(robot.move_index() & 0x7FFFFFFFU);
  if (robot.has_from_rapid()) {
    const auto& numbers = robot.from_rapid().numbers();
    if (!numbers.empty()) {
      if (std::isnan(numbers[0])) return refuse("the spindle speed from RAPID is no number");
      report.spindle_speed_rpm = numbers[0];
    }
    if (numbers.size() > 1) {
      if (!(numbers[1] >= 0.0 && numbers[1] <= kLargestBlock)) return refuse("the block from RAPID is out of range");
      report.block = static_cast<std::int32_t>(numbers[1]);
    }
  }
  parsed.why_not = read_feedback(robot.feedback(), report);
  return parsed;
}

std::string build_egm(EgmAnswer kind, const Setpoint& setpoint, const AnswerHead& head) {
  if (kind == EgmAnswer::path) {
    egm::SensorPathCorrection answer;
    *answer.mutable_header() = header_of(head, egm::Header::PATH_CORRECTION);
    egm::Cartesian& position = *answer.mutable_correction()->mutable_position();
    position.set_x(0.0);
    position.set_y(kEgmMmPerM * setpoint.path_offset);
    position.set_z(0.0);
    answer.mutable_correction()->set_age_ms(0);
    return answer.SerializeAsString();
  }
  egm::Sensor answer;
  *answer.mutable_header() = header_of(head, egm::Header::CORRECTION);
  egm::RapidData& data = *answer.mutable_to_rapid();
  data.set_digital(setpoint.stop);
  data.add_numbers(100.0 * (setpoint.feed_override - 1.0));
  data.add_numbers(setpoint.spindle_change_rpm);
  return answer.SerializeAsString();
}

PacketProtocol egm_protocol(EgmAnswer kind) {
  return {parse_egm, [kind](const ControllerReport&, const Setpoint& setpoint, const AnswerHead& head) {
            return build_egm(kind, setpoint, head);
          }};
}

std::array<const char*, 6> egm_refusals(EgmAnswer kind) {
  if (kind == EgmAnswer::data)
    return {nullptr, nullptr, nullptr, "EGM data: the feed direction stays with the program; use --answer path",
            nullptr, nullptr};
  constexpr const char* kNoSpeeds = "EGM path correction carries no speeds; use --answer data";
  return {nullptr, kNoSpeeds, kNoSpeeds, nullptr, kNoSpeeds, "EGM path correction cannot stop; use --answer data"};
}

std::string build_egm_report(const ControllerReport& report) {
  egm::Robot robot;
  egm::Header& header = *robot.mutable_header();
  header.set_sequence(static_cast<std::uint32_t>(report.counter));
  header.set_time_ms(static_cast<std::uint32_t>(report.clock_us / 1000));
  header.set_type(egm::Header::DATA);
  egm::Feedback& feedback = *robot.mutable_feedback();
  for (const double joint : report.joints) feedback.mutable_joints()->add_values(rad_to_deg(joint));
  egm::Cartesian& position = *feedback.mutable_pose()->mutable_position();
  position.set_x(kEgmMmPerM * report.position[0]);
  position.set_y(kEgmMmPerM * report.position[1]);
  position.set_z(kEgmMmPerM * report.position[2]);
  egm::Quaternion& orientation = *feedback.mutable_pose()->mutable_orientation();
  orientation.set_w(report.orientation[0]);
  orientation.set_x(report.orientation[1]);
  orientation.set_y(report.orientation[2]);
  orientation.set_z(report.orientation[3]);
  feedback.mutable_time()->set_seconds(static_cast<std::uint64_t>(report.clock_us / 1'000'000));
  feedback.mutable_time()->set_microseconds(static_cast<std::uint64_t>(report.clock_us % 1'000'000));
  robot.mutable_rapid_state()->set_state(egm::RapidState::RUNNING);
  robot.mutable_from_rapid()->add_numbers(report.spindle_speed_rpm);
  robot.mutable_from_rapid()->add_numbers(report.block);
  return robot.SerializeAsString();
}

std::optional<MachineInputs> parse_egm_answer(EgmAnswer kind, std::string_view answer) {
  if (kind == EgmAnswer::path) {
    egm::SensorPathCorrection path;
    if (!parse_quietly(path, answer.data(), answer.size()) || !path.has_correction() ||
        path.header().type() != egm::Header::PATH_CORRECTION)
      return std::nullopt;
    return MachineInputs{0.0, 1.0, path.correction().position().y() / kEgmMmPerM, false};
  }
  egm::Sensor sensor;
  if (!parse_quietly(sensor, answer.data(), answer.size()) || sensor.to_rapid().numbers_size() < 2 ||
      sensor.header().type() != egm::Header::CORRECTION)
    return std::nullopt;
  const auto& numbers = sensor.to_rapid().numbers();
  return MachineInputs{numbers[1], 1.0 + 0.01 * numbers[0], 0.0, sensor.to_rapid().digital()};
}

}  // namespace stillcut
