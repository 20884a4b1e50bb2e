#include "tools/spoken.hpp"

#include <array>

#include "dsp/integrity.hpp"

namespace stillcut {
namespace {

template <std::size_t Count, class Value>
const char* name_of(const std::array<const char*, Count>& names, Value value) noexcept {
  const auto at = static_cast<std::size_t>(value);
  return at < Count ? names[at] : "unknown";
}

}  // namespace

const char* state_name(State state) noexcept {
  static constexpr std::array kNames{"idle", "air", "entry", "cut", "exit", "chatter", "cannot tell", "fault"};
  return name_of(kNames, state);
}

const char* mode_name(RuntimeMode mode) noexcept {
  static constexpr std::array kNames{"off", "shadow", "active"};
  return name_of(kNames, mode);
}

const char* correction_name(CorrectionKind kind) noexcept {
  static constexpr std::array kNames{"release",        "spindle speed", "spindle speed variation",
                                     "feed direction", "feed override", "stop request"};
  return name_of(kNames, kind);
}

const char* chatter_name(ChatterKind kind) noexcept {
  static constexpr std::array kNames{"unknown", "regenerative", "structural"};
  return name_of(kNames, kind);
}

std::vector<std::string> limits_reached(std::int32_t limited_by) {
  std::vector<std::string> names;
  if ((limited_by & kLimitedBySpeedRange) != 0) names.emplace_back("speed range");
  if ((limited_by & kLimitedByAcceleration) != 0) names.emplace_back("acceleration");
  if ((limited_by & kLimitedByFeedRange) != 0) names.emplace_back("feed range");
  if ((limited_by & kLimitedByPath) != 0) names.emplace_back("path");
  if ((limited_by & kNoStableSettingKnown) != 0) names.emplace_back("no stable setting known");
  return names;
}

std::vector<std::string> doubt_names(std::uint32_t doubts) {
  std::vector<std::string> names;
  for (int bit = 0; bit < kDoubtCount; ++bit)
    if (const std::uint32_t doubt = 1U << bit; (doubts & doubt) != 0)
      names.emplace_back(describe(static_cast<Doubt>(doubt)));
  return names;
}
}  // namespace stillcut
