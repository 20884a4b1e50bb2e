// What an adapter does with the corrections that have come since it last looked: into the record, to the adapter, its
// answers back to the monitor, and refusals into the log, at most one a second.
#pragma once

#include <spdlog/spdlog.h>

#include <cstdint>

#include "adapters/exchange_log.hpp"
#include "adapters/lcm_link.hpp"

namespace stillcut {

class Complaints {
 public:
  void say(const char* what, std::int64_t now_ns) {
    constexpr std::int64_t kEvery_ns = 1'000'000'000;
    if (now_ns < again_ns_) return;
    again_ns_ = now_ns + kEvery_ns;
    spdlog::warn("refused: {}", what);
  }

 private:
  std::int64_t again_ns_ = 0;
};

template <class Adapter>
void take_corrections(LcmLink& link, ExchangeRecorder& recorder, Adapter& adapter, Complaints& complaints) {
  HeardCorrection heard;
  while (link.next(heard)) {
    recorder.put(heard.received_ns, heard.correction);
    const auto answer = adapter.receive(heard.correction, heard.received_ns);
    if (!answer) continue;
    link.say(*answer);
    recorder.put(heard.received_ns, *answer);
    if (!answer->ack.accepted) complaints.say(answer->reason.data(), heard.received_ns);
  }
}

}  // namespace stillcut
