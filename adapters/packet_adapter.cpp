#include "adapters/packet_adapter.hpp"

namespace stillcut {

PacketOutput PacketAdapter::packet(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  ParsedReport parsed = protocol_.parse(bytes);
  if (parsed.why_not == nullptr) parsed.why_not = reason_to_doubt(parsed.report);
  PacketOutput output;
  if (parsed.why_not != nullptr) {
    ++bad_;
    output.why_not = parsed.why_not;
    return output;
  }
  const std::optional<Setpoint> setpoint = session_.cycle(parsed.report, now_ns);
  if (!setpoint) return output;
  if (answers_ == 0) first_ns_ = now_ns;
  late_answers_ = parsed.report.late_answers;
  const AnswerHead head{++answers_, static_cast<std::uint32_t>((now_ns - first_ns_) / 1'000'000)};
  output.answer = protocol_.build(parsed.report, *setpoint, head);
  output.settled = setpoint->settled();
  output.state = session_.state_due(now_ns);
  return output;
}

}  // namespace stillcut
