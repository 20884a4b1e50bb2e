// `stillcut hz`: how often messages come on LCM channels, how evenly, and how large they are.
#include <unistd.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "drivers/lcm/raw_listener.hpp"
#include "rt/periodic.hpp"
#include "tools/asked_to_end.hpp"
#include "tools/channel_rates.hpp"
#include "tools/commands.hpp"
#include "tools/lcm_address.hpp"

namespace stillcut {
namespace {

constexpr int kHzWait_ms = 20;
constexpr std::int64_t kHzPeriod_ns = 1'000'000'000;

struct HzOptions {
  std::vector<std::string> channels;
  std::string lcm;
  double duration_s = 0.0;
  bool json = false;
};

nlohmann::ordered_json rates_json(const ChannelRates& rates, double duration_s) {
  using Json = nlohmann::ordered_json;
  const auto ms = [](double seconds) { return std::isfinite(seconds) ? Json(1e3 * seconds) : Json(nullptr); };
  Json list = Json::array();
  for (const auto& [name, rate] : rates.channels()) {
    const IntervalSummary all = rate.all();
    list.push_back({{"channel", name},
                    {"messages", all.messages},
                    {"bytes", all.bytes},
                    {"rate_hz", all.mean > 0.0 ? Json(1.0 / all.mean) : Json(nullptr)},
                    {"bytes_per_s", static_cast<double>(all.bytes) / duration_s},
                    {"interval_mean_ms", ms(all.mean)},
                    {"interval_min_ms", ms(all.least)},
                    {"interval_max_ms", ms(all.most)},
                    {"interval_std_ms", ms(all.deviation)},
                    {"gaps", rate.gaps()},
                    {"stamps_back", rate.back()}});
  }
  return {{"duration_s", duration_s}, {"channels", std::move(list)}, {"messages_on_further_channels", rates.beyond()}};
}

void print_rates(const ChannelRates& rates, double period_s, bool terminal) {
  std::cout << (terminal ? "\033[H\033[J" : "") << rates_text(rates, period_s) << (terminal ? "" : "\n") << std::flush;
}

void hz(const HzOptions& options) {
  AskedToEnd asked_to_end;
  const std::string url = lcm_address(options.lcm);
  const std::vector<std::string> patterns =
      options.channels.empty() ? std::vector<std::string>{".*"} : options.channels;
  ChannelRates rates;
  RawListener listener(open_lcm(url), patterns, [&](const RawMessage& message) {
    rates.add(message.channel, message.received_us, message.bytes.size());
  });
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  const std::int64_t start_ns = monotonic_ns();
  std::int64_t period_ns = start_ns;
  const auto passed_s = [](std::int64_t since_ns) { return static_cast<double>(monotonic_ns() - since_ns) * 1e-9; };
  while (!asked_to_end() && (options.duration_s <= 0.0 || passed_s(start_ns) < options.duration_s)) {
    if (!listener.wait(kHzWait_ms)) {
      if (!is_lcm_log(url)) throw ComponentError("LCM at " + url + " cannot be read any more; see 'stillcut doctor'");
      if (!options.json) print_rates(rates, passed_s(period_ns), terminal);
      break;
    }
    if (monotonic_ns() - period_ns < kHzPeriod_ns || options.json) continue;
    print_rates(rates, passed_s(period_ns), terminal);
    rates.begin_period();
    period_ns = monotonic_ns();
  }
  if (options.json)
    std::cout << rates_json(rates, passed_s(start_ns)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << '\n';
}

}  // namespace

void add_hz_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("hz", "How often and how evenly messages come on LCM channels");
  const auto options = std::make_shared<HzOptions>();
  command->add_option("CHANNEL", options->channels, "Names or patterns such as 'STILLCUT_.*' (default: all)")
      ->check(why_no_pattern);
  command->add_option("--lcm", options->lcm, "LCM address, or the cell file that names it (default: LCM's usual one)");
  command->add_option("--duration", options->duration_s, "End after so many seconds (default: on ^C)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", options->json, "At the end, one JSON object on standard output");
  command->footer(
      "Once a second a row a channel: messages and bytes in the last second; intervals (mean, min, max, standard\n"
      "deviation in ms), messages and gaps since the start. A gap is an interval longer than 2.5 times the mean, on\n"
      "channels that come evenly.\n"
      "Example: ten seconds of all that is sent:\n"
      "  stillcut hz --duration 10 --json\n"
      "Example: does the robot's adapter keep its cycle:\n"
      "  stillcut hz ROBOT_STATE --lcm cell.toml");
  command->callback([options] { hz(*options); });
}

}  // namespace stillcut
