#include "adapters/lcm_link.hpp"

#include <chrono>

#include "adapters/exchange_log.hpp"
#include "adapters/udp_port.hpp"

namespace stillcut {
namespace {

constexpr std::chrono::milliseconds kPollOutputs{2};

}  // namespace

LcmLink::LcmLink(const LcmConnection& connection)
    : publisher_{connection},
      listener_{connection,
                {.on_correction =
                     [this](const Correction& correction) {
                       (void)corrections_.push({correction, steady_ns()});
                     },
                 .on_event = {}},
                MonitorListener::Thread::own},
      thread_{[this](const std::stop_token& stop) { publish(stop); }} {}

void LcmLink::publish(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    LinkOutput output;
    while (outputs_.pop(output)) {
      if (output.type == LinkOutput::Type::state) {
        publisher_.publish(output.state);
      } else {
        publisher_.publish(output.answer.ack, text_of(output.answer.reason));
      }
    }
    std::this_thread::sleep_for(kPollOutputs);
  }
}

}  // namespace stillcut
