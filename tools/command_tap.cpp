// stillcut tap: from hammer taps to frequency responses, out of recordings or guided on the cell's CAN bus.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "drivers/files/tap_recording_file.hpp"
#include "tools/commands.hpp"
#include "tools/output_file.hpp"
#include "tools/plot_tap.hpp"
#include "tools/progress.hpp"
#include "tools/simulated_taps.hpp"
#include "tools/tap_live.hpp"
#include "tools/tap_recordings.hpp"
#include "tools/tap_report.hpp"

namespace stillcut {
namespace {

struct TapOptions {
  std::vector<std::string> inputs;
  std::string axis, channels, out, plot, bus, postures, simulate;
  std::vector<std::string> posture, directions{"x", "y", "z"};
  double sense = 1.0, highest_hz = 0.0;
  int hits = 5;
  std::size_t sensor = 1;
  std::uint64_t seed = 1;
  bool binary = false, json = false, replace = false;
  TapEstimator estimator = TapEstimator::h1;
  TapSettings settings;
};

constexpr const char* kBlindToOverloads =
    "an overload would not be seen: tell --force-full-scale and --acceleration-full-scale\n";

NamedRecordings recordings_of(const TapOptions& options) {
  NamedRecordings named{options.inputs, options.sense, {}, {}};
  if (!options.axis.empty()) {
    named.default_direction = parse_direction(options.axis);
    if (!named.default_direction) throw CLI::ValidationError("--axis", "'" + options.axis + "' is none of x, y, z");
    named.default_direction->sense *= options.sense;
  }
  try {
    if (!options.channels.empty()) named.channels = parse_wav_channels(options.channels);
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--channels", error.what());
  }
  return named;
}

TappedDirection estimate_direction(const TapOptions& options, RecordedDirection&& recorded) {
  TapSettings settings = options.settings;
  settings.force_axis = recorded.hammer.axis;
  settings.force_sense = recorded.hammer.sense;
  try {
    if (options.highest_hz > 0.0)
      settings.highest_of_rate = options.highest_hz / recorded.recordings.front().sample_rate_hz;
    TapEstimate estimate = estimate_taps(recorded.recordings, settings);
    return {recorded.hammer, std::move(recorded.recordings), std::move(estimate)};
  } catch (const std::invalid_argument& error) {
    throw InputError(recorded.files.front(), 0, error.what());
  }
}

UffForm form_of(const TapOptions& options) { return options.binary ? UffForm::binary : UffForm::text; }

// A WAV tells the end of its range, others leave it open.
bool is_blind_to_overloads(const TapOptions& options) {
  const TapSettings& s = options.settings;
  const auto tells = [](const std::string& input) { return input.ends_with(".wav") || input.ends_with(".WAV"); };
  return (s.force_full_scale_n == kInfinity || s.acceleration_full_scale_m_per_s2 == kInfinity) &&
         !std::ranges::all_of(options.inputs, tells);
}

std::string decay_text(double added_decay_per_s) {
  const double rounded = std::round(1e4 * added_decay_per_s) / 1e4;
  return added_decay_per_s > 0.0 ? "the exponential window adds " + csv_number(rounded) +
                                       " 1/s to every decay rate; the file says so, and stillcut fit takes it off\n"
                                 : std::string();
}

void tap_from_files(const TapOptions& options) {
  if (!options.out.empty()) check_frf_name(options.out);
  std::vector<std::string> notes;
  std::vector<RecordedDirection> recorded = read_directions(recordings_of(options), notes);
  for (const std::string& note : notes) std::cerr << "stillcut: " << note << '\n';
  Progress progress("estimating");
  std::vector<TappedDirection> directions;
  std::vector<std::vector<std::string>> files;
  for (RecordedDirection& direction : recorded) {
    files.push_back(direction.files);
    directions.push_back(estimate_direction(options, std::move(direction)));
    progress.update(static_cast<double>(directions.size()) / static_cast<double>(recorded.size()));
  }
  progress.finish();
  FrequencyResponse response;
  try {
    response = responses_of(directions, options.estimator);
  } catch (const std::invalid_argument& error) {
    throw InputError(options.inputs.front(), 0, error.what());
  }
  if (!options.out.empty()) write_frf(options.out, response, form_of(options));
  if (!options.plot.empty()) {
    const std::string name = std::filesystem::path(options.out.empty() ? files.front().front() : options.out).stem();
    plot::write_figure(tap_figure("Tap test " + name, directions, response), options.plot);
  }
  nlohmann::ordered_json object{{"directions", nlohmann::ordered_json::array()}, {"notes", notes}};
  for (std::size_t d = 0; d < directions.size(); ++d) {
    const TappedDirection& tapped = directions[d];
    if (options.json) {
      object["directions"].push_back(taps_to_json(tapped.estimate, tapped.hammer, files[d], tapped.recordings));
      continue;
    }
    print_quality(tapped.estimate, tapped.hammer, std::cout);
    print_hits(tapped.estimate, files[d], tapped.recordings, std::cout);
  }
  if (options.json)
    std::cout << object.dump() << '\n';
  else
    std::cout << (is_blind_to_overloads(options) ? kBlindToOverloads : "") << decay_text(response.added_decay_per_s);
}

std::vector<HammerDirection> parse_directions(const TapOptions& options) {
  std::vector<HammerDirection> directions;
  for (const std::string& text : options.directions) {
    const auto direction = parse_direction(text);
    if (!direction) throw CLI::ValidationError("--directions", "'" + text + "' is none of x, y, z, -x, -y, -z");
    for (const HammerDirection& other : directions)
      if (other.axis == direction->axis) throw CLI::ValidationError("--directions", "'" + text + "' is there twice");
    directions.push_back(*direction);
  }
  return directions;
}

std::vector<std::string> posture_ids(const TapOptions& options) {
  std::vector<std::string> ids = options.posture;
  if (!options.postures.empty()) {
    const CsvTable table = read_csv(options.postures);
    const std::size_t column = table.require_column("posture");
    for (const CsvRow& row : table.rows()) {
      const std::string id = table.text(row, column);
      if (options.posture.empty()) ids.push_back(id);
    }
  }
  if (ids.empty()) throw CLI::RequiredError("--posture or --postures");
  return ids;
}

void simulate(const TapOptions& options) {
  const Cell cell = read_cell(options.inputs.front(), {.bus = false});
  std::vector<SimulatedTap> taps;
  for (const HammerDirection hammer : parse_directions(options))
    for (int hit = 0; hit < options.hits; ++hit) taps.push_back({.hammer = hammer});
  const std::vector<std::string> ids = posture_ids(options);
  OutputFile file(options.simulate);
  Progress progress("tapping");
  const std::int64_t frames =
      write_simulated_taps(cell, ids, taps, {.spacing_s = 1.0 + options.settings.record_s, .seed = options.seed},
                           file.stream(), [&](double share) { progress.update(share); });
  progress.finish();
  file.finish();
  if (options.simulate == "-") return;
  if (options.json)
    std::cout << nlohmann::ordered_json{{"frames", frames}, {"hits", taps.size() * ids.size()}}.dump() << '\n';
  else
    std::cout << taps.size() * ids.size() << " hits at " << ids.size() << " postures, " << frames << " frames\n";
}

void tap_on_bus(const TapOptions& options) {
  if (options.out.empty()) throw CLI::RequiredError("--out");
  const Cell cell = read_cell(options.inputs.front(), {.map = false, .bus = options.bus.empty()});
  LiveTapOptions live;
  live.bus = options.bus;
  live.sensor = options.sensor - 1;
  live.postures = posture_ids(options);
  live.places = options.postures;
  live.directions = parse_directions(options);
  live.hits = options.hits;
  live.settings = options.settings;
  live.highest_hz = options.highest_hz;
  live.estimator = options.estimator;
  live.out = options.out;
  live.form = form_of(options);
  live.replace = options.replace;
  std::vector<TappedPosture> postures;
  try {
    postures = tap_live(cell, live, std::cin, options.json ? std::cerr : std::cout);
  } catch (const std::invalid_argument& error) {
    throw InputError(options.inputs.front(), 0, error.what());
  }
  nlohmann::ordered_json object{{"postures", nlohmann::ordered_json::array()}};
  for (const TappedPosture& tapped : postures) {
    nlohmann::ordered_json directions = nlohmann::ordered_json::array();
    for (const TappedDirection& direction : tapped.directions) {
      const std::vector<std::string> files(direction.recordings.size(), tapped.posture);
      directions.push_back(taps_to_json(direction.estimate, direction.hammer, files, direction.recordings));
    }
    object["postures"].push_back({{"posture", tapped.posture}, {"directions", directions}});
  }
  if (!options.plot.empty() && !postures.empty()) {
    const TappedPosture& last = postures.back();
    plot::write_figure(tap_figure("Tap test at posture " + last.posture, last.directions, last.response), options.plot);
  }
  if (options.json)
    std::cout << object.dump() << '\n';
  else if (!postures.empty())
    std::cout << postures.size() << " of " << live.postures.size() << " postures in " << options.out << "\n"
              << decay_text(postures.back().response.added_decay_per_s);
}

void tap(const TapOptions& options) {
  if (!options.plot.empty()) plot::check_picture_name(options.plot);
  const bool cell = std::filesystem::path(options.inputs.front()).extension() == ".toml";
  if (!cell && !options.simulate.empty()) throw CLI::ValidationError("--simulate", "needs a cell file");
  if (!cell) return tap_from_files(options);
  if (options.inputs.size() > 1) throw CLI::ValidationError("INPUT", "is one cell file, or recordings");
  options.simulate.empty() ? tap_on_bus(options) : simulate(options);
}

void add_settings(CLI::App& command, TapOptions& options) {
  TapSettings& s = options.settings;
  const auto number = [&](const char* name, double& value, const char* text) {
    return command.add_option(name, value, text)->capture_default_str();
  };
  number("--record", s.record_s, "Length of a hit's record, s");
  number("--before", s.before_s, "Of that before the force rises, s");
  number("--trigger", s.trigger_n, "A force from here up is a hit, N");
  number("--least-peak", s.least_peak_n, "A weaker hit is refused, N");
  number("--force-window", s.force_window_s, "Force is kept for so long after it rises, s");
  number("--end-weight", s.end_weight, "Of the exponential window at the record's end; 1: no such window");
  command.add_option("--force-full-scale", s.force_full_scale_n,
                     "Where the hammer's range ends, N (default: not known)");
  command.add_option("--acceleration-full-scale", s.acceleration_full_scale_m_per_s2,
                     "Where the accelerometer's range ends, m/s² (default: not known)");
  command
      .add_option("--highest", options.highest_hz,
                  "Highest frequency of the responses, Hz (default: 0.4 of the sample rate)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--estimator", options.estimator,
                  "h1, right where the responses are noisy, h2 where the force is, or hv (default: h1)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, TapEstimator>{
          {"h1", TapEstimator::h1}, {"h2", TapEstimator::h2}, {"hv", TapEstimator::hv}}));
}

}  // namespace

void add_tap_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("tap", "Hammer taps to frequency responses: from recordings, or guided on the cell's CAN bus");
  const auto options = std::make_shared<TapOptions>();
  command
      ->add_option("INPUT", options->inputs,
                   "Recordings of one posture (.uff, .csv, .wav; x=FILE says the hammer's axis), or a cell file")
      ->required();
  command->add_option("--out", options->out, "Responses: a .uff, .unv or .csv file; with a cell a folder");
  command->add_option("--axis", options->axis, "The hammer's axis, x, y or z, where a recording does not tell it");
  command->add_option("--sense", options->sense, "-1: struck towards that axis' minus")
      ->check(CLI::IsMember({1.0, -1.0}));
  command->add_option(
      "--channels", options->channels,
      "Of a WAV file, in order, with their value at digital full scale: force:2000N,x:500m/s^2,y:50g,-");
  command->add_option("--posture", options->posture, "With a cell: ids of the postures, in turn")->delimiter(',');
  command->add_option("--postures", options->postures,
                      "With a cell: postures.csv with the ids and places; the rows of those done go to --out");
  command->add_option("--directions", options->directions, "With a cell: where the hammer strikes (default: x,y,z)")
      ->delimiter(',');
  command->add_option("--hits", options->hits, "With a cell: sound hits a direction")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--bus", options->bus, "With a cell: another bus than its own, such as log:taps.log");
  command->add_option("--sensor", options->sensor, "With a cell: which of its accelerometers is at the tool's point")
      ->capture_default_str()
      ->check(CLI::Range(1, kMaxSensors));
  command->add_flag("--replace", options->replace, "With a cell: measure postures again that --out holds already");
  command->add_option("--simulate", options->simulate,
                      "With a cell: write instead what hammer and sensors would send of taps at its map's postures");
  command->add_option("--seed", options->seed, "Of the simulated noise")->capture_default_str();
  add_settings(*command, *options);
  command->add_flag("--binary", options->binary, "Universal files in binary (58b)");
  command->add_option("--plot", options->plot,
                      "Draw pulses, responses and coherence, with a cell of the last posture, to .svg or .png");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Example: three recordings of a posture, one a direction of the hammer, to one file:\n"
      "  stillcut tap x=12-x.wav y=12-y.wav z=12-z.wav --channels force:2000N,x:50g,y:50g,z:50g --out 12.uff --plot "
      "12.svg\n"
      "Example: guided, on the cell's CAN bus; then the same tried without a robot:\n"
      "  stillcut tap cell.toml --postures postures.csv --out taps\n"
      "  stillcut tap examples/demo-cell/cell.toml --posture home --simulate taps.log\n"
      "  stillcut tap examples/demo-cell/cell.toml --posture home --bus log:taps.log --out taps");
  command->callback([options] { tap(*options); });
}

}  // namespace stillcut
