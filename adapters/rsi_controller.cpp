#include "adapters/rsi_controller.hpp"

#include "adapters/rsi_xml.hpp"

namespace stillcut {

ControllerProtocol rsi_controller_protocol() {
  return {[](const ControllerReport& report) {
            return build_rsi_report(report, {0.0, 0.0, 0.0});
          },
          [](std::string_view answer, const ControllerReport& sent) -> std::optional<MachineInputs> {
            const auto request = parse_rsi_answer(answer);
            if (!request || request->ipoc != sent.counter) return std::nullopt;  // an answer to an earlier packet: late
            return MachineInputs{request->spindle_rpm, 1.0 + 0.01 * request->feed_percent, 0.0, request->stop};
          }};
}

}  // namespace stillcut
