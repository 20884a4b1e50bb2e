// `stillcut echo`: what is sent on LCM channels, field by field.
#include <iostream>
#include <nlohmann/json.hpp>

#include "drivers/lcm/raw_listener.hpp"
#include "rt/periodic.hpp"
#include "tools/asked_to_end.hpp"
#include "tools/commands.hpp"
#include "tools/lcm_address.hpp"
#include "tools/message_json.hpp"
#include "tools/message_text.hpp"

namespace stillcut {
namespace {

constexpr int kEchoWait_ms = 50;
constexpr std::int64_t kEchoSilence_ns = 3'000'000'000;

struct EchoOptions {
  std::vector<std::string> channels;
  std::string lcm;
  std::int64_t count = 0;
  bool list = false, json = false, all = false;
};

void list_channels(bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const KnownChannel& channel : known_channels()) {
    const MessageSchema* schema = find_schema(std::string_view{channel.type});
    const std::string what = schema != nullptr ? schema->comment : std::string{};
    if (json)
      list.push_back({{"channel", channel.name},
                      {"type", channel.type},
                      {"recorded_only", channel.recorded_only},
                      {"carries", what}});
    else
      std::cout << padded(channel.name, 22) << padded(channel.type, 18)
                << (channel.recorded_only ? "only in recordings. " : "") << what << '\n';
  }
  if (json) std::cout << nlohmann::ordered_json{{"channels", std::move(list)}}.dump() << '\n';
}

void print_message(const RawMessage& message, const EchoOptions& options) {
  if (options.json)
    std::cout << message_json(message.channel, message.bytes, message.received_us)
                     .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << '\n';
  else
    std::cout << message_text(message.channel, message.bytes, message.received_us, options.all);
  std::cout.flush();
}

void echo(const EchoOptions& options) {
  if (options.list) return list_channels(options.json);
  if (options.channels.empty())
    throw CLI::ValidationError("CHANNEL", "which one? --list names those of Stillcut; '.*' is all");
  AskedToEnd asked_to_end;
  const std::string url = lcm_address(options.lcm);
  std::int64_t heard = 0;
  RawListener listener(open_lcm(url), options.channels, [&](const RawMessage& message) {
    if (options.count > 0 && heard >= options.count) return;
    ++heard;
    print_message(message, options);
  });
  const std::int64_t start_ns = monotonic_ns();
  bool told = false;
  while (!asked_to_end() && (options.count == 0 || heard < options.count)) {
    if (!listener.wait(kEchoWait_ms)) {
      if (is_lcm_log(url)) return;
      throw ComponentError("LCM at " + url + " cannot be read any more; see 'stillcut doctor'");
    }
    if (told || heard > 0 || monotonic_ns() - start_ns < kEchoSilence_ns) continue;
    told = true;
    std::cerr << "stillcut: nothing was heard at " << url << " for 3 s; does the daemon run: stillcutd CELL\n";
  }
}

}  // namespace

void add_echo_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("echo", "Print what is sent on LCM channels, field by field");
  const auto options = std::make_shared<EchoOptions>();
  command->add_option("CHANNEL", options->channels, "Names of channels, or patterns such as 'STILLCUT_.*'")
      ->check(why_no_pattern);
  command->add_option("--lcm", options->lcm, "LCM address, or the cell file that names it (default: LCM's usual one)");
  command->add_option("--count", options->count, "End after so many messages (default: on ^C)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--all", options->all, "All values of long arrays");
  command->add_flag("--list", options->list, "The channels of Stillcut, and what they carry");
  command->add_flag("--json", options->json, "One JSON object for each message, a line each");
  command->footer(
      "Messages of other types are shown by fingerprint, size and first bytes; broken ones with what is wrong.\n"
      "Example: what the daemon thinks, and what it asks of the robot:\n"
      "  stillcut echo STILLCUT_MONITOR STILLCUT_CORRECTION\n"
      "Example: the next state that the robot tells:\n"
      "  stillcut echo ROBOT_STATE --lcm cell.toml --count 1 --json");
  command->callback([options] { echo(*options); });
}

}  // namespace stillcut
