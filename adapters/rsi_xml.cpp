#include "adapters/rsi_xml.hpp"

#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <cstdio>

#include "models/machining.hpp"

namespace stillcut {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kLargestPacket = 4096;
constexpr std::int64_t kUsPerMs = 1000;
constexpr std::int64_t kLastIpoc = 9'000'000'000'000;  // ms: so many fit as nanoseconds
constexpr double kMmPerM = 1e3;

// The whole text as a number; nothing else may stand there.
template <class Number>
std::optional<Number> number_of(const char* text) {
  if (text == nullptr) return std::nullopt;
  const std::string_view whole{text};
  Number number{};
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
  if (error != std::errc{} || end != whole.data() + whole.size()) return std::nullopt;
  return number;
}

std::optional<double> attribute(const XMLElement& element, const char* name) {
  const auto number = number_of<double>(element.Attribute(name));
  return number && std::isfinite(*number) ? number : std::nullopt;
}

// Reads the attributes named, each scaled; false when one is missing or no number.
template <std::size_t N>
bool read(const XMLElement& element, const std::array<const char*, N>& names, double scale, double* values) {
  for (std::size_t i = 0; i < N; ++i) {
    const auto value = attribute(element, names[i]);
    if (!value) return false;
    values[i] = *value * scale;
  }
  return true;
}

constexpr std::array<const char*, 3> kPosition{"X", "Y", "Z"}, kAngles{"A", "B", "C"};
constexpr std::array<const char*, 6> kAxes{"A1", "A2", "A3", "A4", "A5", "A6"};

const char* read_pose(const XMLElement& root, ControllerReport& report) {
  const XMLElement* pose = root.FirstChildElement("RIst");
  if (pose == nullptr) return "RIst is missing; send it in the RSI configuration";
  std::array<double, 3> angles{};
  if (!read(*pose, kPosition, 1.0 / kMmPerM, report.position.data()) ||
      !read(*pose, kAngles, deg_to_rad(1.0), angles.data()))
    return "RIst does not hold six numbers X, Y, Z, A, B, C";
  report.orientation = quaternion_of_zyx(angles[0], angles[1], angles[2]);
  const XMLElement* axes = root.FirstChildElement("AIPos");
  if (axes != nullptr && !read(*axes, kAxes, deg_to_rad(1.0), report.joints.data()))
    return "AIPos does not hold six numbers A1 to A6";
  return nullptr;
}

const char* read_program(const XMLElement& root, ControllerReport& report) {
  if (const XMLElement* own = root.FirstChildElement("Stillcut")) {
    if (own->Attribute("Speed") != nullptr) {
      const auto speed = attribute(*own, "Speed");
      if (!speed) return "Stillcut.Speed is no number";
      report.spindle_speed_rpm = *speed;
    }
    if (own->Attribute("Block") != nullptr) {
      const auto block = number_of<std::int32_t>(own->Attribute("Block"));
      if (!block) return "Stillcut.Block is no whole number";
      report.block = *block;
    }
  }
  if (const XMLElement* delay = root.FirstChildElement("Delay"))
    report.late_answers = number_of<std::int64_t>(delay->Attribute("D")).value_or(0);
  return nullptr;
}

}  // namespace

ParsedReport parse_rsi(std::span<const std::uint8_t> packet) {
  ParsedReport parsed;
  const auto refuse = [&](const char* why_not) { return ParsedReport{{}, why_not}; };
  if (packet.empty() || packet.size() > kLargestPacket) return refuse("not of a size that RSI sends");
  tinyxml2::XMLDocument document;
  if (document.Parse(reinterpret_cast<const char*>(packet.data()), packet.size()) != tinyxml2::XML_SUCCESS)
    return refuse("not XML");
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view{root->Name()} != "Rob") return refuse("its root is not Rob");
  const XMLElement* ipoc = root->FirstChildElement("IPOC");
  const auto counter = ipoc == nullptr ? std::nullopt : number_of<std::int64_t>(ipoc->GetText());
  if (!counter || *counter < 0 || *counter > kLastIpoc) return refuse("IPOC is missing, or no whole number");
  parsed.report.counter = *counter;
  parsed.report.clock_us = *counter * kUsPerMs;
  parsed.why_not = read_pose(*root, parsed.report);
  if (parsed.why_not == nullptr) parsed.why_not = read_program(*root, parsed.report);
  return parsed;
}

std::string build_rsi(std::int64_t ipoc, const Setpoint& setpoint) {
  std::array<char, 512> text{};
  const int length = std::snprintf(text.data(), text.size(),
                                   R"(<Sen Type="Stillcut"><RKorr X="0.0" Y="0.0" Z="0.0" A="0.0" B="0.0" C="0.0"/>)"
                                   R"(<Stillcut Feed="%.2f" Speed="%.1f" Stop="%d"/><IPOC>%lld</IPOC></Sen>)",
                                   100.0 * (setpoint.feed_override - 1.0), setpoint.spindle_change_rpm,
                                   setpoint.stop ? 1 : 0, static_cast<long long>(ipoc));
  return {text.data(), static_cast<std::size_t>(length)};
}

std::string build_rsi_report(const ControllerReport& report, const std::array<double, 3>& angles_deg) {
  std::array<char, 1024> text{};
  std::array<double, 6> a{};
  for (std::size_t i = 0; i < a.size(); ++i) a[i] = rad_to_deg(report.joints[i]);
  const auto& p = report.position;
  const int length =
      std::snprintf(text.data(), text.size(),
                    R"(<Rob Type="KUKA"><RIst X="%.4f" Y="%.4f" Z="%.4f" A="%.4f" B="%.4f" C="%.4f"/>)"
                    R"(<AIPos A1="%.4f" A2="%.4f" A3="%.4f" A4="%.4f" A5="%.4f" A6="%.4f"/><Delay D="%lld"/>)"
                    R"(<Stillcut Speed="%.1f" Block="%d"/><IPOC>%lld</IPOC></Rob>)",
                    kMmPerM * p[0], kMmPerM * p[1], kMmPerM * p[2], angles_deg[0], angles_deg[1], angles_deg[2], a[0],
                    a[1], a[2], a[3], a[4], a[5], static_cast<long long>(report.late_answers), report.spindle_speed_rpm,
                    report.block, static_cast<long long>(report.counter));
  return {text.data(), static_cast<std::size_t>(length)};
}

std::optional<RsiRequest> parse_rsi_answer(std::string_view answer) {
  tinyxml2::XMLDocument document;
  if (document.Parse(answer.data(), answer.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view{root->Name()} != "Sen") return std::nullopt;
  const XMLElement* own = root->FirstChildElement("Stillcut");
  const XMLElement* ipoc = root->FirstChildElement("IPOC");
  if (own == nullptr || ipoc == nullptr) return std::nullopt;
  const auto feed = attribute(*own, "Feed"), speed = attribute(*own, "Speed"), stop = attribute(*own, "Stop");
  const auto counter = number_of<std::int64_t>(ipoc->GetText());
  if (!feed || !speed || !stop || !counter) return std::nullopt;
  return RsiRequest{*feed, *speed, *stop != 0.0, *counter};
}

std::array<const char*, 6> rsi_refusals() {
  return {nullptr, nullptr, nullptr, "RSI: the feed direction stays with the program", nullptr, nullptr};
}

}  // namespace stillcut
