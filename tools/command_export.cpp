// `stillcut export`: a recording, or a window of it, as CSV, WAV, universal file or MCAP.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "tools/commands.hpp"
#include "tools/event_csv.hpp"
#include "tools/export_mcap.hpp"
#include "tools/export_samples.hpp"
#include "tools/output_file.hpp"
#include "tools/playback.hpp"
#include "tools/recorded_frames.hpp"
#include "tools/recording_options.hpp"
#include "tools/sample_window.hpp"

namespace stillcut {
namespace {

struct ExportOptions {
  std::string cell;
  PlaybackSource source;
  double from_s = 0.0, to_s = kInfinity;
  std::string csv, events, wav, uff, mcap;
  int sensor = 0;             // from 1; 0: not named
  double wav_full_scale = 0;  // m/s²; 0: the loudest sample
  bool json = false;
};

constexpr double kLongestGap_s = 3600.0;  // filled; a clock that was set may leap by years

void check_options(const ExportOptions& options) {
  const std::array<const std::string*, 5> files{&options.csv, &options.events, &options.wav, &options.uff,
                                                &options.mcap};
  if (std::all_of(files.begin(), files.end(), [](const std::string* file) { return file->empty(); }))
    throw CLI::RequiredError("one of --csv, --events, --wav, --uff, --mcap");
  const auto to_stdout =
      std::count_if(files.begin(), files.end(), [](const std::string* file) { return *file == "-"; });
  if (to_stdout + (options.json ? 1 : 0) > 1)
    throw CLI::ValidationError("'-' and --json", "only one thing can go to standard output; name files for the others");
  if (options.wav == "-" || options.mcap == "-")
    throw CLI::ValidationError("--wav and --mcap", "are no text for standard output; name a file");
  const auto place = [](const std::string& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file));
  };
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t j = i + 1; j < files.size(); ++j)
      if (!files[i]->empty() && !files[j]->empty() && place(*files[i]) == place(*files[j]))
        throw CLI::ValidationError(*files[i], "is named for two outputs; name a file for each");
  if (!(options.to_s > options.from_s)) throw CLI::ValidationError("--to", "must be after --from");
}

// The files asked for. Those of an export that fails are taken away again, so that none is mistaken for a result.
class ExportFiles {
 public:
  ExportFiles(const ExportOptions& options, std::span<const AccelerometerSettings> sensors, std::size_t wav_sensor)
      : options_{options}, sensors_{sensors}, wav_sensor_{wav_sensor} {
    if (!options.csv.empty()) csv_.emplace(csv_file_.emplace(options.csv).stream());
    if (!options.events.empty()) write_event_header(events_file_.emplace(options.events).stream());
    if (!options.uff.empty()) {
      uff_file_.emplace(options.uff);
      uff_.emplace(sensors);
    }
    if (!options.mcap.empty()) mcap_.emplace(mcap_file_.emplace(options.mcap).stream(), sensors);
    if (!options.wav.empty()) wav_.emplace(options.wav, sensors[wav_sensor]);
  }
  ~ExportFiles() {
    if (finished_) return;
    std::error_code stays;
    for (const std::string* file : {&options_.csv, &options_.events, &options_.uff, &options_.mcap, &options_.wav})
      if (std::filesystem::is_regular_file(*file, stays)) std::filesystem::remove(*file, stays);
  }
  ExportFiles(const ExportFiles&) = delete;
  ExportFiles& operator=(const ExportFiles&) = delete;

  [[nodiscard]] bool asks_for_decisions() const { return events_file_ || mcap_; }

  void add(const SampleStretch& stretch, double speed_rpm, std::int64_t origin_ns) {
    const auto sensor = static_cast<std::size_t>(stretch.sensor);
    if (options_.sensor != 0 && sensor + 1 != static_cast<std::size_t>(options_.sensor)) return;
    if (static_cast<double>(stretch.missing) * stretch.step_s > kLongestGap_s) fail_of_gap(stretch);
    samples_ += stretch.samples;
    missing_ += stretch.missing;
    if (csv_) csv_->add(stretch, speed_rpm);
    if (uff_) add_to_uff(stretch);
    if (mcap_ && stretch.samples > 0) mcap_->add(stretch, origin_ns);
    if (wav_ && sensor == wav_sensor_) {
      wav_->add(stretch);
      wav_samples_ += stretch.samples;
    }
    still_whole();
  }
  void add(const SpindleReading& reading) {
    if (mcap_) mcap_->add(reading);
  }
  void add(const Output& output, std::int64_t origin_ns) {
    if (mcap_) mcap_->add(output);
    if (!events_file_ || output.type != Output::Type::event) return;
    write_event(events_file_->stream(), output.event, origin_ns);
    ++events_;
  }
  void add(const RobotMessage& message) {
    if (mcap_) mcap_->add(message);
  }

  // What was asked for and is not in the window is told, not written as an empty file.
  void finish(const PlaybackSummary& played) {
    const std::string span = "the recording spans 0 to " + csv_number(std::floor(played.played_s * 1e6) / 1e6) + " s";
    if (!(options_.from_s <= played.played_s)) throw InputError(options_.source.can, 0, "no such window: " + span);
    const bool of_samples = csv_ || uff_ || wav_;
    if ((of_samples && samples_ == 0) || (wav_ && wav_samples_ == 0))
      throw InputError(options_.source.can, 0, "holds no sample of the sensor in this window; " + span);
    if (wav_) full_scale_ = wav_->finish(options_.wav_full_scale);
    if (uff_) uff_->write(uff_file_->stream());
    if (mcap_) mcap_->finish();
    for (std::optional<OutputFile>* file : {&csv_file_, &events_file_, &uff_file_, &mcap_file_})
      if (*file) (*file)->finish();
    finished_ = true;
  }

  [[nodiscard]] nlohmann::ordered_json summary(const PlaybackSummary& played) const {
    nlohmann::ordered_json json{{"played_s", played.played_s},       {"start_utime", played.origin_ns / 1000},
                                {"frames", played.frames},           {"frames_bad", played.frames_bad},
                                {"frames_lost", played.frames_lost}, {"samples", samples_},
                                {"samples_missing", missing_}};
    if (events_file_) json["events"] = events_;
    if (wav_) json["wav_full_scale_m_per_s2"] = full_scale_;
    if (wav_) json["wav_sample_rate_hz"] = wav_->sample_rate_hz();
    if (mcap_) json["mcap_messages"] = mcap_->messages();
    return json;
  }

  void tell(const PlaybackSummary& played, std::ostream& out) const {
    const auto in_ms = [](double value) { return csv_number(std::round(value * 1e3) / 1e3); };
    out << samples_ << " samples from " << in_ms(options_.from_s) << " s to "
        << in_ms(std::min(options_.to_s, played.played_s)) << " s";
    if (missing_ > 0) out << ", " << missing_ << " more are missing (empty in CSV, silence in WAV, 0 in UFF)";
    out << '\n';
    if (wav_)
      out << options_.wav << ": full scale is " << in_ms(full_scale_) << " m/s², " << wav_->sample_rate_hz()
          << " samples a second\n";
    if (mcap_) out << options_.mcap << ": " << mcap_->messages() << " messages\n";
  }

 private:
  void add_to_uff(const SampleStretch& stretch) {
    try {
      uff_->add(stretch);
    } catch (const std::length_error& error) {
      throw InputError(options_.uff, 0, error.what());
    }
  }
  // A disk that is full ends the export at once, not after hours.
  void still_whole() {
    for (std::optional<OutputFile>* file : {&csv_file_, &mcap_file_})
      if (*file && !(*file)->stream()) (*file)->finish();
  }
  [[noreturn]] void fail_of_gap(const SampleStretch& stretch) const {
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(),
                  "sensor %d is silent for %.1f h from %.3f s on (was a clock set?); export the parts before and after "
                  "with --from and --to",
                  stretch.sensor + 1, static_cast<double>(stretch.missing) * stretch.step_s / 3600.0, stretch.begin_s);
    throw InputError(options_.source.can, 0, text.data());
  }

  const ExportOptions& options_;
  std::span<const AccelerometerSettings> sensors_;
  std::size_t wav_sensor_;
  std::optional<OutputFile> csv_file_, events_file_, uff_file_, mcap_file_;
  std::optional<SampleCsv> csv_;
  std::optional<SampleUff> uff_;
  std::optional<McapExport> mcap_;
  std::optional<SampleWav> wav_;
  std::int64_t samples_ = 0, missing_ = 0, wav_samples_ = 0, events_ = 0;
  double full_scale_ = 0.0;
  bool finished_ = false;
};

void export_recording(const ExportOptions& options) {
  check_options(options);
  const bool decide = !options.events.empty() || !options.mcap.empty();
  const Cell cell = read_cell(options.cell, {.map = decide, .bus = false});
  const std::vector<AccelerometerSettings>& sensors = require(cell, cell.can, "can").accelerometers;
  if (options.sensor > static_cast<int>(sensors.size()))
    throw CLI::ValidationError("--sensor", "the cell has " + std::to_string(sensors.size()) + " accelerometers");
  if (sensors.empty())
    throw InputError(options.cell, cell.can->line, "can.accelerometer: is missing; add a [[can.accelerometer]] table");

  refuse_to_overwrite(playback_files(options.source.can, options.source.lcm),
                      {options.csv, options.events, options.wav, options.uff, options.mcap});
  ExportFiles files{options, sensors, static_cast<std::size_t>(std::max(options.sensor, 1) - 1)};
  SampleWindow window{sensors, options.from_s, options.to_s};
  double speed_rpm = kNaN;
  std::int64_t origin_ns = 0;
  const auto in_window = [&](std::int64_t stamp_ns) {
    const auto us = [](double seconds) { return std::round(seconds * 1e6); };  // as events are written
    const double time_us = std::round(static_cast<double>(stamp_ns - origin_ns) * 1e-3);
    return time_us >= us(options.from_s) && time_us < us(options.to_s);
  };
  PlaybackListener listener;
  listener.on_frame = [&](const Pipeline& pipeline) {
    origin_ns = pipeline.core().origin_ns();
    const Decoded& decoded = pipeline.decoded();
    if (decoded.has_speed) {
      speed_rpm = rad_s_to_rpm(decoded.spindle.speed);
      if (in_window(decoded.spindle.stamp_ns)) files.add(decoded.spindle);
    }
    for (int b = 0; b < decoded.blocks; ++b) {
      if (const auto stretch = window.cut(decoded.block[static_cast<std::size_t>(b)], origin_ns))
        files.add(*stretch, speed_rpm, origin_ns);
    }
  };
  listener.on_output = [&](const Output& output, const Core& core) {
    origin_ns = core.origin_ns();
    const std::int64_t stamp_ns = output.type == Output::Type::event        ? output.event.stamp_ns
                                  : output.type == Output::Type::correction ? output.correction.stamp_ns
                                                                            : output.status.stamp_ns;
    if (in_window(stamp_ns)) files.add(output, origin_ns);
  };
  listener.on_robot = [&](const RobotMessage& message) {
    const std::int64_t stamp_ns = std::visit([](const auto& m) { return m.stamp_ns; }, message);
    if (origin_ns != 0 && in_window(stamp_ns)) files.add(message);
  };
  constexpr double kLate_s = 1.0;  // a sample comes later than it was taken
  const PlaybackSummary played = play(cell, options.source, decide, options.to_s + kLate_s, listener);
  for (const std::string& warning : played.warnings) std::cerr << "stillcut: " << warning << '\n';
  files.finish(played);
  if (options.json)
    std::cout << files.summary(played).dump() << '\n';
  else if (options.csv != "-" && options.events != "-" && options.uff != "-")
    files.tell(played, std::cout);
}

}  // namespace

void add_export_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("export", "Write a recording, or a window of it, as CSV, WAV, UFF or MCAP");
  auto options = std::make_shared<ExportOptions>();
  command->add_option("CELL", options->cell, "cell file")->required();
  add_recording_options(*command, options->source);
  command->add_option("--from", options->from_s, "begin of the window, in seconds since the first frame as events say")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--to", options->to_s, "end of the window")->check(CLI::NonNegativeNumber);
  command
      ->add_option("--sensor", options->sensor, "only this accelerometer of the cell, counted from 1 (WAV: default 1)")
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", options->csv, "write the samples and the spindle speed as CSV ('-': standard output)");
  command->add_option("--events", options->events, "write the window's events as CSV ('-': standard output)");
  command->add_option("--wav", options->wav, "write the samples as sound, an axis a channel");
  command
      ->add_option("--wav-peak", options->wav_full_scale,
                   "m/s² of the WAV file's full scale; default: the loudest sample")
      ->check(CLI::PositiveNumber);
  command->add_option("--uff", options->uff, "write time histories as a universal file (dataset 58, binary)");
  command->add_option("--mcap", options->mcap, "write samples, speed, events, corrections, status and robot as MCAP");
  command->add_flag("--json", options->json, "print one JSON object");
  command->footer(
      "Example:\n  stillcut export cell.toml --can /var/lib/stillcut/recording --from 3 --to 5 --wav cut.wav --csv "
      "cut.csv");
  command->callback([options] { export_recording(*options); });
}

}  // namespace stillcut
