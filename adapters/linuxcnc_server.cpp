#include "adapters/linuxcnc_server.hpp"

#include <array>
#include <charconv>
#include <cstdio>
#include <optional>
#include <vector>

#include "adapters/linuxcnc_lines.hpp"

namespace stillcut {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

std::optional<int> percent_of(std::string_view text) {
  int percent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), percent);
  if (error != std::errc{} || end != text.data() + text.size() || percent < 0 || percent > 200) return std::nullopt;
  return percent;
}

template <class... Values>
std::string printed(const char* format, Values... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

MachineInputs LinuxCncServer::inputs(bool stop) const {
  return {program_.settings().spindle_speed_rpm * (0.01 * spindle_percent_ - 1.0), 0.01 * feed_percent_, 0.0, stop};
}

void LinuxCncServer::step(double seconds) { program_.step(seconds, inputs(false)); }

std::string LinuxCncServer::line(std::string_view text) {
  const std::string with_verb = "line " + std::string{text};  // values_of leaves out the first word
  const std::vector<std::string_view> words = values_of(with_verb);
  if (words.empty()) return {};
  const auto word = [&](std::size_t i) { return i < words.size() ? words[i] : std::string_view{}; };
  if (word(0) == "HELLO") {
    linked_ = word(1) == "EMC" && words.size() == 4;
    return std::string{linked_ ? "HELLO ACK EMCNETSVR 1.1" : "HELLO NAK"}.append(kLineEnd);
  }
  if (!linked_) return {};
  if (word(0) == "GET") return get(word(1)).append(kLineEnd);
  if (word(0) == "SET") {
    const std::string verdict = set(word(1), word(2));
    if (verdict == "ACK" && !verbose_) return {};
    return std::string{"SET "}.append(word(1)).append(" ").append(verdict).append("\n\r");
  }
  return {};
}

std::string LinuxCncServer::set(std::string_view name, std::string_view value) {
  constexpr const char *kDone = "ACK", *kRefused = "NAK";
  if (name == "VERBOSE" || name == "ECHO") {
    if (name == "VERBOSE") verbose_ = value == "ON";
    return kDone;
  }
  if (name == "ENABLE") {
    enabled_ = value == "EMCTOO";
    return enabled_ ? kDone : kRefused;
  }
  if (!enabled_ || !machine_on_) return kRefused;
  if (name == "PAUSE") {
    program_.step(0.0, inputs(true));
    return kDone;
  }
  const auto percent = percent_of(value);
  if (!percent) return kRefused;
  if (name == "FEED_OVERRIDE") {
    feed_percent_ = *percent;
  } else if (name == "SPINDLE_OVERRIDE") {
    spindle_percent_ = *percent;
  } else {
    return kRefused;
  }
  return kDone;
}

std::string LinuxCncServer::get(std::string_view name) const {
  const auto position = program_.position();
  if (name == "USER_LINEAR_UNITS") return "USER_LINEAR_UNITS MM";
  if (name == "JOINT_TYPE") return "JOINT_TYPE LINEAR LINEAR LINEAR";
  if (name == "REL_ACT_POS" || name == "JOINT_POS")
    return std::string{name} +
           printed(" %f %f %f 0.000000 0.000000 0.000000", 1e3 * position[0], 1e3 * position[1], 1e3 * position[2]);
  if (name == "PROGRAM_CODES")
    return printed("PROGRAM_CODES G1 G17 G21 G90 G94 F%.0f S%.0f", 6e4 * program_.settings().feed_m_per_s,
                   program_.settings().spindle_speed_rpm);
  if (name == "PROGRAM_LINE") return printed("PROGRAM_LINE %d", program_.block());
  if (name == "PROGRAM_STATUS") return program_.stopped() ? "PROGRAM_STATUS PAUSED" : "PROGRAM_STATUS RUNNING";
  if (name == "FEED_OVERRIDE") return printed("FEED_OVERRIDE %d", feed_percent_);
  if (name == "SPINDLE_OVERRIDE") return printed("SPINDLE_OVERRIDE 0 %d", spindle_percent_);
  return std::string{"GET "}.append(name).append(" NAK");
}

}  // namespace stillcut
