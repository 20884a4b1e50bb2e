// What `stillcut export --mcap` writes: the samples and all that was heard, decided and answered, on topics of their
// own, as JSON under JSON schemas.
#pragma once

#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/files/mcap_writer.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "rt/signals.hpp"
#include "tools/sample_window.hpp"

namespace stillcut {

// Topics: /vibration/sensor_1 … (a message a CAN frame), /spindle, /events, /corrections, /status, /robot_state,
// /robot_ack. Log times are those of the CAN stamps' clock, in ns since 1970; what is not known is left out of a
// message.
class McapExport {
 public:
  McapExport(std::ostream& out, std::span<const AccelerometerSettings> sensors);

  void add(const SampleStretch& stretch, std::int64_t origin_ns);
  void add(const SpindleReading& reading);
  void add(const Output& output);
  void add(const RobotMessage& message);  // a path is passed over
  void finish() { writer_.finish(); }

  [[nodiscard]] std::uint64_t messages() const { return writer_.messages(); }

 private:
  McapWriter writer_;
  std::vector<McapWriter::Channel> vibration_;
  McapWriter::Channel spindle_, event_, correction_, status_, robot_state_, robot_ack_;
  std::string json_;
};

}  // namespace stillcut
