#include "drivers/lcm/publisher.hpp"

namespace stillcut {

bool Publisher::publish(const Output& output) {
  switch (output.type) {
    case Output::Type::event:
      return send(kEventChannel, encode(output.event));
    case Output::Type::correction:
      return send(kCorrectionChannel, encode(output.correction));
    case Output::Type::status:
      return send(kStatusChannel, encode(output.status));
  }
  return false;
}

bool Publisher::publish(const RobotState& state) { return send(kRobotStateChannel, encode(state)); }

bool Publisher::publish(const RobotPath& path) { return send(kRobotPathChannel, encode(path)); }

bool Publisher::publish(const CorrectionAck& ack, std::string_view reason) {
  return send(kRobotAckChannel, encode(ack, reason));
}

bool Publisher::publish(const TelemetryMessage& message) {
  return send(channel_of(message), std::visit([](const auto& m) { return encode(m); }, message));
}

bool Publisher::send(const char* channel, const MessageBytes& bytes) {
  const auto length = static_cast<unsigned int>(bytes.size());
  const bool ok = lcm_publish(connection_.get(), channel, bytes.data(), length) == 0;
  (ok ? sent_ : failed_).fetch_add(1, std::memory_order_relaxed);
  return ok;
}

}  // namespace stillcut
