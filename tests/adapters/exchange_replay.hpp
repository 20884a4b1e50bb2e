// Plays a recorded exchange through the adapter's own code: what came in goes in at the same times, and what goes out
// is listed as the recording lists it.
#pragma once

#include <string>
#include <vector>

#include "adapters/exchange_log.hpp"
#include "adapters/packet_adapter.hpp"
#include "drivers/lcm/messages.hpp"

namespace stillcut {

inline bool goes_out(ExchangeKind kind) {
  return kind == ExchangeKind::answer || kind == ExchangeKind::ack || kind == ExchangeKind::state;
}

inline std::vector<ExchangeEntry> outgoing(const std::vector<ExchangeEntry>& entries) {
  std::vector<ExchangeEntry> out;
  for (const ExchangeEntry& entry : entries)
    if (goes_out(entry.kind)) out.push_back(entry);
  return out;
}

inline void put_ack(std::vector<ExchangeEntry>& out, std::int64_t time_ns, const std::optional<Answer>& answer) {
  if (!answer) return;
  const MessageBytes bytes = encode(answer->ack, text_of(answer->reason));
  out.push_back({time_ns, ExchangeKind::ack, std::string{text_of(bytes)}});
}

inline void put_state(std::vector<ExchangeEntry>& out, std::int64_t time_ns, const std::optional<RobotState>& state) {
  if (state) out.push_back({time_ns, ExchangeKind::state, std::string{text_of(encode(*state))}});
}

inline std::vector<ExchangeEntry> replay(const std::vector<ExchangeEntry>& entries, PacketAdapter& adapter) {
  std::vector<ExchangeEntry> out;
  for (const ExchangeEntry& entry : entries) {
    if (entry.kind == ExchangeKind::correction)
      put_ack(out, entry.time_ns, adapter.receive(decode_correction(bytes_of(entry.bytes)).value, entry.time_ns));
    if (entry.kind != ExchangeKind::packet) continue;
    const PacketOutput output = adapter.packet(bytes_of(entry.bytes), entry.time_ns);
    if (!output.answer.empty()) out.push_back({entry.time_ns, ExchangeKind::answer, output.answer});
    put_state(out, entry.time_ns, output.state);
  }
  return out;
}

}  // namespace stillcut
