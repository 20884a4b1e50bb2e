#include "adapters/adapter_options.hpp"

#include <iostream>

#include "adapters/udp_port.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr int kUsage = 2, kBadInput = 3, kComponentMissing = 4;  // as every program of Stillcut ends

}  // namespace

std::string complain_of_address(const std::string& text) {
  return read_ipv4_address(text) ? "" : "'" + text + "' is no address; write 192.168.1.10:49152, or the port alone";
}

void add_adapter_options(CLI::App& app, AdapterOptions& options) {
  app.add_option("CELL", options.cell, "cell file: spindle limits, programmed speed, LCM address")->required();
  app.add_option("--lcm", options.lcm, "LCM address, instead of the cell's");
  app.add_option("--min-feed", options.min_feed_percent, "lowest feed override, per cent")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 100.0));
  app.add_option("--max-feed", options.max_feed_percent, "highest feed override, per cent")
      ->capture_default_str()
      ->check(CLI::Range(100.0, 200.0));
  app.add_option("--record", options.record, "write the whole exchange to FILE, for a test or a question");
  app.add_option("--duration", options.duration_s, "end after this many seconds (default: on SIGTERM)");
}

AdapterSettings adapter_settings(const AdapterOptions& options, const std::array<const char*, 6>& refusals) {
  const Cell cell = read_cell(options.cell, {.map = false, .dbc = false, .bus = false});
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  const Cut& cut = require(cell, cell.cut, "cut");
  AdapterSettings settings;
  settings.lcm_url = options.lcm.empty() ? cell.lcm_url : options.lcm;
  settings.session.nominal_speed_rpm = rad_s_to_rpm(cut.spindle_speed);
  settings.session.nominal_feed_direction = cut.feed_direction;
  settings.session.cycle_ns = static_cast<std::int64_t>(options.cycle_ms * 1e6);
  FollowerSettings& follower = settings.session.follower;
  follower.refusals = refusals;
  follower.min_speed_rpm = rad_s_to_rpm(spindle.min_speed);
  follower.max_speed_rpm = rad_s_to_rpm(spindle.max_speed);
  follower.speed_rate_rpm_per_s = rad_s_to_rpm(spindle.acceleration);
  follower.min_feed_override = 0.01 * options.min_feed_percent;
  follower.max_feed_override = 0.01 * options.max_feed_percent;
  follower.max_path_offset = 1e-3 * options.max_path_offset_mm;
  return settings;
}

int run_adapter_program(CLI::App& app, int argc, char** argv, const std::function<void()>& run) {
  const auto complain = [&](const std::string& what, int code) {
    std::cerr << app.get_name() << ": " << what << '\n';
    return code;
  };
  try {
    app.parse(argc, argv);
    run();
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return complain(std::string{error.what()} + "; see '" + app.get_name() + " --help'", kUsage);
  } catch (const InputError& error) {
    return complain(error.what(), kBadInput);
  } catch (const ComponentError& error) {
    return complain(error.what(), kComponentMissing);
  } catch (const std::exception& error) {
    return complain(error.what(), 1);
  }
}

}  // namespace stillcut
