// Messages of the daemon as onlookers hear them: the first byte chooses the channel, the rest is what came on it.
#include "drivers/lcm/message_schema.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const char* channel = telemetry_channels()[data[0] % telemetry_channels().size()];
  const auto message = decode_telemetry(channel, {data + 1, size - 1});
  const MessageReading reading = read_message({data + 1, size - 1});
  if (!message.ok()) return 0;
  require_that(reading.why_not.empty(), "what is understood can be read by the text of its .lcm file");
  require_that(std::string_view{channel_of(message.value)} == channel, "it is of the channel on which it came");
  const MessageBytes again = std::visit([](const auto& m) { return encode(m); }, message.value);
  require_that(decode_telemetry(channel, again).ok(), "what was understood can be sent on");
  return 0;
}
