// stillcut simulate: mills in simulated time, and writes what the tool did and what the cell's sensors would have sent.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "drivers/can/candump_log.hpp"
#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "drivers/files/robot_file.hpp"
#include "models/cut_schedule.hpp"
#include "models/robot_milling.hpp"
#include "tools/can_encoder.hpp"
#include "tools/cell_posture.hpp"
#include "tools/commands.hpp"
#include "tools/output_file.hpp"
#include "tools/plot_simulation.hpp"
#include "tools/progress.hpp"
#include "tools/roughness_json.hpp"
#include "tools/surface_recorder.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kLogOrigin =
    1'700'000'000'000'000'000;                    // ns: logs carry dates; a fixed one keeps them repeatable
constexpr double kRateGrain = 1000.0;             // Hz: rates of rows are round, and a little above the lowest
constexpr std::int64_t kMaxPlotRows = 4'000'000;  // bounds the memory that a picture takes

struct SimulateOptions {
  std::string cell, robot, posture, depth, speed, csv, can, plot;
  RobotIntegrator integrator = RobotIntegrator::whole;
  double duration_s = 0.0, rate_hz = 0.0, noise_m_per_s2 = 0.2, force_noise = 0.02;
  std::uint64_t seed = 1;
  bool json = false;
};

// "0:0,0.5:2.5" to a schedule, each value times `unit`.
Schedule parse_schedule(const std::string& option, const std::string& text, double unit) {
  Schedule schedule;
  const auto number = [&](const std::string& part) {
    std::size_t used = 0;
    double value = 0.0;
    try {
      value = std::stod(part, &used);
    } catch (const std::exception&) {
      used = std::string::npos;
    }
    if (used != part.size() || !std::isfinite(value) || value < 0.0)
      throw CLI::ValidationError(option, "'" + text + "' is not a list TIME:VALUE,TIME:VALUE of numbers from 0 up");
    return value;
  };
  for (const std::string& pair : CLI::detail::split(text, ',')) {
    const std::size_t colon = std::min(pair.find(':'), pair.size());
    const double time = number(pair.substr(0, colon));
    const double value = number(colon < pair.size() ? pair.substr(colon + 1) : "");
    if (!schedule.empty() && time < schedule.back().time) throw CLI::ValidationError(option, "times must not go back");
    schedule.push_back({time, value * unit});
  }
  return schedule;
}

// The robot of a file at its home posture, or at the joint angles that were asked for.
Arm read_arm(const SimulateOptions& options) {
  Arm arm = read_robot(options.robot);
  if (options.posture.empty()) return arm;
  const std::vector<std::string> angles = CLI::detail::split(options.posture, ',');
  if (angles.size() != arm.joints.size())
    throw CLI::ValidationError("--posture", "with --robot takes one angle a joint, in degrees: " +
                                                std::to_string(arm.joints.size()) + " with commas between");
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!CLI::detail::lexical_cast(angles[i], arm.joints[i].home))
      throw CLI::ValidationError("--posture", "'" + angles[i] + "' is no angle in degrees");
    arm.joints[i].home = deg_to_rad(arm.joints[i].home);
  }
  if (const std::string beyond = beyond_limits(arm, home_angles(arm)); !beyond.empty())
    throw CLI::ValidationError("--posture", beyond);
  return arm;
}

MillingSetup setup_of(const Cell& cell, const SimulateOptions& options) {
  MillingSetup setup;
  setup.tool = require(cell, cell.tool, "tool");
  setup.material = require(cell, cell.material, "material");
  setup.cut = require(cell, cell.cut, "cut");
  setup.force_noise = options.force_noise;
  setup.seed = options.seed;
  if (!options.robot.empty()) return setup;
  const PredictedPosture predicted = predicted_posture(cell, read_cell_dynamics(cell), options.posture);
  if (predicted.outside) std::cerr << "stillcut: " << options.cell << ": " << outside_map_text(predicted) << '\n';
  setup.modes = predicted.posture.modes;
  return setup;
}

CutSchedule schedule_of(const SimulateOptions& options) {
  CutSchedule schedule;
  if (!options.depth.empty()) schedule.axial_depth = parse_schedule("--depth", options.depth, 1e-3);
  if (!options.speed.empty()) schedule.spindle_speed = parse_schedule("--speed", options.speed, rpm_to_rad_s(1.0));
  return schedule;
}

// What a simulation refuses is said of the file that it comes from: options were looked at before.
template <typename Make>
auto said_of(const std::filesystem::path& file, Make make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), 0, error.what());
  }
}

// Rows are dense enough for the modes, and for the sensors where there are any to feed.
double row_rate_hz(const Cell& cell, const MillingSetup& setup, const SimulateOptions& options) {
  const double lowest = lowest_sample_rate_hz(setup.modes);
  if (options.rate_hz > 0.0 && options.rate_hz < lowest)
    throw CLI::ValidationError("--rate", "the highest mode needs at least " + csv_number(std::ceil(lowest)) + " Hz");
  if (options.rate_hz > 0.0) return options.rate_hz;
  double rate = (std::floor(lowest / kRateGrain) + 1.0) * kRateGrain;
  if (!options.can.empty() && cell.can)
    for (const AccelerometerSettings& sensor : cell.can->accelerometers) rate = std::max(rate, sensor.sample_rate_hz);
  return rate;
}

class CsvOutput {
 public:
  explicit CsvOutput(const std::string& name) : file_{name} {
    file_.stream() << "time_s,fx_n,fy_n,fz_n,x_um,y_um,z_um,chip_um,spindle_speed_rpm\n";
  }
  void write(const MillingState& s) {
    std::array<char, 256> row{};
    const int length =
        std::snprintf(row.data(), row.size(), "%.12g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.9g\n", s.time, s.force.x(),
                      s.force.y(), s.force.z(), s.displacement.x() * 1e6, s.displacement.y() * 1e6,
                      s.displacement.z() * 1e6, s.chip * 1e6, rad_s_to_rpm(s.spindle_speed));
    file_.stream().write(row.data(), length);
  }
  void finish() { file_.finish(); }

 private:
  OutputFile file_;
};

class CanOutput {
 public:
  CanOutput(const std::string& name, const Cell& cell, const SimulateOptions& options)
      : file_{name},
        encoder_{read_dbc(require(cell, cell.can, "can").dbc),
                 *cell.can,
                 cell.file.string(),
                 {options.noise_m_per_s2, options.seed},
                 kLogOrigin} {}
  void write(const MillingState& s) {
    std::array<char, kMaxCandumpLine> line{};
    for (const CanFrame& frame : encoder_.advance(s.time, s.velocity, s.spindle_speed)) {
      file_.stream().write(line.data(), static_cast<std::streamsize>(format_candump_line(frame, "can0", line)));
      ++frames_;
    }
  }
  void finish() { file_.finish(); }
  [[nodiscard]] std::int64_t frames() const { return frames_; }
  [[nodiscard]] std::int64_t saturated() const { return encoder_.saturated(); }

 private:
  OutputFile file_;
  CanEncoder encoder_;
  std::int64_t frames_ = 0;
};

struct Peaks {
  double displacement = 0.0, force = 0.0, acceleration = 0.0, chip = 0.0;  // SI

  void add(const MillingState& s) {
    displacement = std::max(displacement, s.displacement.norm());
    force = std::max(force, s.force.norm());
    acceleration = std::max(acceleration, s.acceleration.norm());
    chip = std::max(chip, s.chip);
  }
};

std::string surface_text(const SurfaceRecorder& surface, const std::optional<ProfileRoughness>& roughness) {
  if (!roughness) return std::string("no 0.8 mm of ") + surface.name() + " to measure";
  std::array<char, 96> text{};
  (void)std::snprintf(text.data(), text.size(), "%s Ra %.2f, Rq %.2f, Rt %.2f µm", surface.name(), 1e6 * roughness->ra,
                      1e6 * roughness->rq, 1e6 * roughness->rt);
  return text.data();
}

void print_summary(const SimulateOptions& options, std::int64_t rows, double rate_hz, const Peaks& peaks,
                   const SurfaceRecorder& surface, const std::optional<CanOutput>& can) {
  if (can && can->saturated() > 0)
    std::cerr << "stillcut: " << options.can << ": " << can->saturated()
              << " samples stand at the end of the sensor's range\n";
  if (!options.json && (options.csv == "-" || options.can == "-")) return;
  const std::optional<ProfileRoughness> roughness = mean_of(surface.lengths());
  if (options.json) {
    nlohmann::ordered_json summary{{"duration_s", options.duration_s},
                                   {"rows", rows},
                                   {"row_rate_hz", rate_hz},
                                   {"peak_force_n", peaks.force},
                                   {"peak_displacement_um", peaks.displacement * 1e6},
                                   {"peak_acceleration_m_per_s2", peaks.acceleration},
                                   {"largest_chip_um", peaks.chip * 1e6},
                                   {"surface", surface.name()},
                                   {"ra_um", um_json(roughness, &ProfileRoughness::ra)},
                                   {"rq_um", um_json(roughness, &ProfileRoughness::rq)},
                                   {"rt_um", um_json(roughness, &ProfileRoughness::rt)}};
    if (can) summary.update({{"frames", can->frames()}, {"samples_saturated", can->saturated()}});
    std::cout << summary.dump() << '\n';
  } else {
    std::printf("%g s milled: peak force %.0f N, displacement %.0f µm, acceleration %.0f m/s², chip %.0f µm; %s\n",
                options.duration_s, peaks.force, peaks.displacement * 1e6, peaks.acceleration, peaks.chip * 1e6,
                surface_text(surface, roughness).c_str());
  }
}

void simulate(const SimulateOptions& options) {
  const int to_stdout = (options.csv == "-" ? 1 : 0) + (options.can == "-" ? 1 : 0) + (options.json ? 1 : 0);
  if (to_stdout > 1)
    throw CLI::ValidationError("-", "only one of --csv -, --can - and --json can have standard output");
  if (!options.plot.empty()) plot::check_picture_name(options.plot);
  const Cell cell = read_cell(options.cell, {.dbc = !options.can.empty(), .bus = false});
  const CutSchedule schedule = schedule_of(options);
  MillingSetup setup = said_of(cell.file, [&] { return scheduled(setup_of(cell, options), schedule); });
  if (!options.robot.empty())
    setup = said_of(options.robot, [&] { return held_by_robot(setup, read_arm(options), options.integrator); });
  const double rate_hz = row_rate_hz(cell, setup, options);
  const auto rows = static_cast<std::int64_t>(std::floor(options.duration_s * rate_hz * (1.0 + 1e-12))) + 1;
  if (!options.plot.empty() && rows > kMaxPlotRows)
    throw CLI::ValidationError("--plot", "too long for a picture; draw a shorter --duration");
  MillingSimulation milling = said_of(cell.file, [&] { return MillingSimulation(setup, rate_hz); });
  std::optional<CsvOutput> csv;
  std::optional<CanOutput> can;
  if (!options.csv.empty()) csv.emplace(options.csv);
  if (!options.can.empty()) can.emplace(options.can, cell, options);

  Peaks peaks;
  SurfaceRecorder surface{setup.tool, setup.cut, 1.0 / rate_hz};
  std::vector<MillingState> states;
  Progress progress("milling");
  std::string stopped;  // why, where the motion could not be continued
  std::int64_t written = 0;
  for (; written < rows; ++written) {
    try {
      if (written > 0) milling.advance(conditions_at(setup, schedule, static_cast<double>(written) / rate_hz));
    } catch (const std::runtime_error& error) {
      stopped = error.what();
      break;
    }
    const MillingState& state = milling.state();
    if (csv) csv->write(state);
    if (can) can->write(state);
    if (!options.plot.empty()) states.push_back(state);
    peaks.add(state);
    if (written > 0) surface.add(state, milling.conditions());
    if (written % 1024 == 0) progress.update(static_cast<double>(written) / static_cast<double>(rows));
  }
  progress.finish();
  if (csv) csv->finish();
  if (can) can->finish();
  if (!options.plot.empty())
    plot::write_figure(simulation_figure("Simulated cut: " + setup.material.name, states), options.plot);
  if (!stopped.empty())
    throw InputError((options.robot.empty() ? cell.file : std::filesystem::path(options.robot)).string(), 0,
                     "the simulation stopped " + stopped);
  print_summary(options, rows, rate_hz, peaks, surface, can);
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("simulate", "Mill in simulated time; write motion, forces and sensor frames");
  const auto options = std::make_shared<SimulateOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--duration", options->duration_s, "How long to mill, s")->required()->check(CLI::PositiveNumber);
  command->add_option("--depth", options->depth, "Axial depth over time, s:mm,s:mm,... (default: the cell's)");
  command->add_option("--speed", options->speed, "Spindle speed over time, s:rpm,s:rpm,... (default: the cell's)");
  command->add_option("--robot", options->robot,
                      "Hold the tool by the robot of a .urdf file, which moves along the feed, not by the cell's map");
  command
      ->add_option("--integrator", options->integrator,
                   "Of the robot: whole, all its equations of motion, or linearised, much faster")
      ->transform(CLI::CheckedTransformer(std::map<std::string, RobotIntegrator>{
          {"whole", RobotIntegrator::whole}, {"linearised", RobotIntegrator::linearised}}))
      ->needs("--robot");
  command->add_option("--posture", options->posture,
                      "Posture of the dynamics map (default: the cell's); with --robot its joint angles in degrees");
  command->add_option("--csv", options->csv, "Write time, force, displacement, chip and speed; - is standard output");
  command->add_option("--can", options->can, "Write what the sensors would send, as candump -L does");
  command->add_option("--plot", options->plot, "Draw the cut to a .svg or .png file");
  command
      ->add_option("--rate", options->rate_hz,
                   "Rows a second (default: 20 a period of the highest mode, or the sensors')")
      ->check(CLI::PositiveNumber);
  command->add_option("--noise", options->noise_m_per_s2, "Sensor noise, m/s² rms")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command->add_option("--force-noise", options->force_noise, "Variation of the cutting force, rms, relative")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 0.5));
  command->add_option("--seed", options->seed, "Of both noises")->capture_default_str();
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Example: air, entry, a sound cut, then so deep that it chatters, exit:\n"
      "  stillcut simulate examples/demo-cell/cell.toml --duration 6 --can cut.log --plot cut.svg \\\n"
      "    --depth 0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,5.3:3.6,5.4:0\n"
      "The robot itself, from its description:\n"
      "  stillcut simulate examples/demo-robot/cell.toml --robot examples/demo-robot/robot.urdf \\\n"
      "    --duration 2 --plot cut.svg");
  command->callback([options] { simulate(*options); });
}

}  // namespace stillcut
