// stillcut fit: measured frequency responses, a file a posture, to a dynamics map.
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "drivers/files/input_error.hpp"
#include "tools/commands.hpp"
#include "tools/fit_output.hpp"
#include "tools/fit_study.hpp"
#include "tools/plot_fit.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

struct FitOptions {
  std::vector<std::string> files, poles;
  std::string postures, out, band, plots;
  int order = IdentificationSettings{}.most_order;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  PoleMethod method = PoleMethod::lscf;
  bool json = false;
};

constexpr int kLeastOrder = 4, kMostOrder = 40;  // poles have to agree over three orders

double frequency_of(const std::string& option, std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= 0.0 && value <= 1e6))
    throw CLI::ValidationError(option, "\"" + std::string(text) + "\" is no frequency in Hz");
  return value;
}

std::vector<double> frequencies_of(const std::string& option, std::string_view text, char between) {
  std::vector<double> values;
  while (true) {
    const std::size_t at = text.find(between);
    values.push_back(frequency_of(option, text.substr(0, at)));
    if (at == std::string_view::npos) return values;
    text.remove_prefix(at + 1);
  }
}

FitQuestion question_of(const FitOptions& options) {
  FitQuestion question{.files = options.files, .postures = options.postures, .settings = {}, .poles_hz = {}};
  question.jobs = options.jobs;
  question.settings.most_order = options.order;
  question.settings.method = options.method;
  if (!options.band.empty()) {
    const std::vector<double> band = frequencies_of("--band", options.band, ':');
    if (band.size() != 2 || !(band[0] < band[1]))
      throw CLI::ValidationError("--band", "must be MIN:MAX in Hz, rising; not \"" + options.band + "\"");
    question.settings.lowest_hz = band[0];
    question.settings.highest_hz = band[1];
  }
  for (const std::string& text : options.poles) {
    const std::size_t at = text.rfind('=');
    auto& poles = at == std::string::npos ? question.settings.poles_hz : question.poles_hz[text.substr(0, at)];
    if (!poles.empty()) throw CLI::ValidationError("--poles", "\"" + text + "\": given twice");
    poles = frequencies_of("--poles", at == std::string::npos ? text : text.substr(at + 1), ',');
    std::sort(poles.begin(), poles.end());
    if (std::adjacent_find(poles.begin(), poles.end()) != poles.end())
      throw CLI::ValidationError("--poles", "\"" + text + "\": a frequency stands twice");
  }
  return question;
}

void draw(const FitStudy& study, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder.string(), 0, "cannot be made (" + error.message() + ")");
  Progress progress("drawing");
  const std::size_t count = study.postures.size();
  for (std::size_t p = 0; p < count; ++p) {
    plot::write_figure(response_figure(study, p), folder / ("frf-" + study.map.postures[p].id + ".png"));
    progress.update(static_cast<double>(p + 1) / static_cast<double>(count + 1));
  }
  plot::write_figure(assurance_figure(study), folder / "mac.svg");
  plot::write_figure(track_figure(study), folder / "frequencies.svg");
}

void run_fit(const FitOptions& options) {
  const FitQuestion question = question_of(options);
  Progress progress("fitting");
  const FitStudy study = fit_map(question, [&](double share) { progress.update(share); });
  progress.finish();
  std::error_code none;
  if (!study.without_responses.empty() &&
      std::filesystem::equivalent(options.postures, std::filesystem::path(options.out) / "postures.csv", none))
    throw InputError(options.postures, 0,
                     "would lose posture " + study.without_responses.front() +
                         ", which no file of responses is of; write the map to another folder");
  write_fitted_map(study, options.out);
  if (!options.plots.empty()) draw(study, options.plots);
  if (options.json)
    std::cout << fit_to_json(study).dump() << '\n';
  else
    print_fit(study, std::cout);
}

}  // namespace

void add_fit_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("fit", "Measured frequency responses to a dynamics map");
  const auto options = std::make_shared<FitOptions>();
  command
      ->add_option("FRF", options->files, "Files of frequency responses, .uff, .unv or .csv; the name is the posture's")
      ->required();
  command->add_option("--out", options->out, "Folder for the map: modes.csv, postures.csv, uncertainty.csv")
      ->required();
  command->add_option("--postures", options->postures,
                      "Where the postures are: posture,j1_deg,...,j6_deg,x_mm,y_mm,z_mm, joints where there are some");
  command
      ->add_option("--poles", options->poles,
                   "Your own choice of modes by frequency in Hz, F,F,...; for one posture ID=F,F,... (may be repeated)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--band", options->band, "Fit within MIN:MAX Hz only");
  command->add_option("--order", options->order, "Stabilization chart up to so many pairs of poles an octave")
      ->check(CLI::Range(kLeastOrder, kMostOrder))
      ->capture_default_str();
  command->add_option("--method", options->method, "What the chart is made of: lscf or polynomials")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, PoleMethod>{{"lscf", PoleMethod::lscf}, {"polynomials", PoleMethod::polynomials}}));
  command->add_option("--plots", options->plots, "Folder for pictures: frf-POSTURE.png, mac.svg and frequencies.svg");
  command->add_option("--jobs", options->jobs, "Threads")->check(CLI::Range(1, 256));
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Modes are found in each file, numbered alike over the postures and written with their standard deviations.\n"
      "Example: the map of three postures, with pictures:\n"
      "  stillcut fit home.uff left.uff right.uff --postures postures.csv --out map --plots pictures\n"
      "Example: the modes at the peaks you chose:\n"
      "  stillcut fit home.uff --out map --poles 55,125,498");
  command->callback([options] { run_fit(*options); });
}

}  // namespace stillcut
