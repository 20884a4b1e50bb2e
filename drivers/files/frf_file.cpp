#include "drivers/files/frf_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "drivers/files/csv.hpp"
#include "drivers/files/frf_csv.hpp"
#include "drivers/files/input_error.hpp"
#include "drivers/files/measured_units.hpp"
#include "drivers/files/text_file.hpp"
#include "drivers/files/uff_numbers.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr double kSameFrequency = 1e-6;  // relative: six digits of a text file
constexpr double kSameUnit = 1e-3;       // relative
constexpr double kRoundedCoherence = 1e-6;
constexpr const char* kAxisNames = "xyz";
// In a line of text of a function, before a number and what follows it.
constexpr std::string_view kDecayText = "added decay ", kDecayUnit = " 1/s";
constexpr std::string_view kForceErrorText = "force error ", kForceErrorUnit = " relative";
constexpr int kLineOfNodes = 7;  // of a dataset 58, after its first

bool names_no_unit(const std::string& label) {
  return label.empty() || label == "NONE" || label == "none" || label == "None";
}

// A label of the ordinate may say the force as well: "(m/s^2)/N", "(1/N)*(m/s^2)".
struct OrdinateLabel {
  std::string response, force;  // force empty: not said
};

OrdinateLabel split_label(std::string label) {
  OrdinateLabel parts;
  const auto slash = label.rfind('/'), product = label.find(")*");
  if (label.starts_with("(1/") && product != std::string::npos) {
    parts.force = label.substr(3, product - 3);
    label = label.substr(product + 2);
  } else if (slash != std::string::npos && force_unit(label.substr(slash + 1))) {
    parts.force = label.substr(slash + 1);
    label.resize(slash);
  }
  if (label.starts_with('(') && label.ends_with(')')) label = label.substr(1, label.size() - 2);
  parts.response = label;
  return parts;
}

// 0 unknown, 1 general: the writer does not tell the quantity.
bool is_open(int data_type) { return data_type == 0 || data_type == 1; }

// Reads the functions of one file, one after the other, into a response.
class FrfReader {
 public:
  FrfReader(const UffFile& content, const std::string& file) : content_(content), file_(file) {}

  FrfFile read() {
    for (const UffFunction& function : content_.functions)
      if (function.type == kUffFrequencyResponse) add(function);
    std::size_t others = 0;
    for (const UffFunction& function : content_.functions)
      if (function.type != kUffFrequencyResponse && !add_coherence(function)) ++others;
    if (first_ == nullptr) throw InputError(file_, 0, "has no frequency response (function type 4 of dataset 58)");
    if (others > 0)
      result_.notes.push_back(std::to_string(others) + " functions that are no frequency response are left out");
    if (si_assumed_) result_.notes.emplace_back("no units are given (dataset 164 or axis labels); SI is assumed");
    if (result_.response.frequencies_hz.front() == 0.0 && no_receptance_) leave_zero_out();
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const UffFunction& function, const std::string& message) const {
    throw InputError(file_, function.line, message);
  }

  void add(const UffFunction& function) {
    if (!function.complex) fail(function, "a frequency response of real numbers; export it as complex");
    const std::size_t response = axis_of(function, function.response_direction, "response direction");
    const std::size_t force = axis_of(function, function.reference_direction, "reference direction");
    const OrdinateLabel label = split_label(function.ordinate.units);
    std::string force_label = function.denominator.units;
    if (names_no_unit(force_label)) force_label = label.force;
    const ResponseKind kind = kind_of(function, label.response, force_label);
    no_receptance_ = no_receptance_ || kind != ResponseKind::receptance;
    const bool turned = (function.response_direction < 0) != (function.reference_direction < 0);
    const double scale =
        (turned ? -1.0 : 1.0) * unit_of(function, label.response, true) / unit_of(function, force_label, false);
    const std::vector<double> hz = frequencies_of(function);
    ComplexValues values = function.values;
    for (std::complex<double>& value : values) value *= scale;
    ComplexValues& entry = result_.response.receptance[response][force];
    if (!entry.empty())
      fail(function, std::string("response ") + kAxisNames[response] + " to force " + kAxisNames[force] +
                         " stands in the file twice; leave one of them");
    entry = receptance_of(kind, hz, values);
    for (std::size_t i = 0; i < hz.size(); ++i)
      if ((hz[i] > 0.0 || kind == ResponseKind::receptance) &&
          !(std::isfinite(entry[i].real()) && std::isfinite(entry[i].imag())))
        fail(function, "point " + std::to_string(i + 1) + " is not finite as receptance in m/N; are its units right?");
    add_decay(function);
  }

  // Of an entry that was read; false for any other function.
  bool add_coherence(const UffFunction& function) {
    const int response = std::abs(function.response_direction), force = std::abs(function.reference_direction);
    if (function.type != kUffCoherence || function.complex || first_ == nullptr || response < 1 || response > 3 ||
        force < 1 || force > 3 || function.abscissa != first_->abscissa)
      return false;
    const auto axis = static_cast<std::size_t>(response - 1), column = static_cast<std::size_t>(force - 1);
    std::vector<double>& coherence = result_.response.coherence[axis][column];
    if (result_.response.receptance[axis][column].empty() || !coherence.empty()) return false;
    for (const std::complex<double>& value : function.values) {
      if (value.real() < 0.0 || value.real() > 1.0 + kRoundedCoherence)
        fail(function, "a coherence must be from 0 to 1");
      coherence.push_back(std::min(1.0, value.real()));
    }
    return true;
  }

  // Told in a line of text, as uff_of() writes it; 0 where none does.
  double told(const UffFunction& function, std::string_view before, std::string_view after) const {
    double value = 0.0;
    for (const std::string& text : function.id) {
      if (!text.starts_with(before)) continue;
      const std::optional<double> number = fortran_number(uff_bare(
          std::string_view(text).substr(before.size(), std::min(text.find(after), text.size()) - before.size())));
      if (!number || *number < 0.0)
        fail(function,
             "\"" + text + "\" must tell a number from 0 up," + std::string(after) + "; correct or remove this line");
      value = *number;
    }
    return value;
  }

  void add_decay(const UffFunction& function) {
    const double decay = told(function, kDecayText, kDecayUnit);
    if (&function != first_ && decay != result_.response.added_decay_per_s)
      fail(function, "another exponential window than the function of line " + std::to_string(first_->line) +
                         "; give files of one measurement");
    result_.response.added_decay_per_s = decay;
    result_.response.force_error =
        std::max(result_.response.force_error, told(function, kForceErrorText, kForceErrorUnit));
  }

  std::size_t axis_of(const UffFunction& function, int direction, const char* name) const {
    const int axis = std::abs(direction);
    if (axis < 1 || axis > 3)
      fail(function, std::string(name) + ": " + std::to_string(direction) +
                         " is no translation; give the points their directions in the instrument, or 1, 2 or 3 for x, "
                         "y, z in line " +
                         std::to_string(function.line + kLineOfNodes));
    return static_cast<std::size_t>(axis - 1);
  }

  static bool is_force(int data_type) { return data_type == kUffReactionForce || data_type == kUffExcitationForce; }

  // A quantity that is left open follows from its unit's label.
  ResponseKind kind_of(const UffFunction& function, const std::string& response, const std::string& force) const {
    const int over = function.ordinate.data_type, under = function.denominator.data_type;
    if (is_force(over) && !is_force(under)) fail(function, "force over response: swapped; export response over force");
    if (!is_force(under) && !(is_open(under) && force_unit(force)))
      fail(function, "ordinate's denominator: data type " + std::to_string(under) + " is no force, 13 or 9");
    if (over == kUffDisplacement) return ResponseKind::receptance;
    if (over == kUffVelocity) return ResponseKind::mobility;
    if (over == kUffAcceleration) return ResponseKind::accelerance;
    if (const auto unit = motion_unit(response); unit && is_open(over)) return unit->kind;
    fail(function,
         "ordinate: data type " + std::to_string(over) + " is no displacement (8), velocity (11) or acceleration (12)");
  }

  // In SI, of the response (length with its powers of time) or the force.
  double unit_of(const UffFunction& function, const std::string& label, bool response) {
    std::optional<double> by_dataset, by_label;
    if (content_.units) by_dataset = 1.0 / (response ? content_.units->length : content_.units->force);
    if (!response)
      by_label = force_unit(label);
    else if (const auto unit = motion_unit(label))
      by_label = unit->si;
    if (!names_no_unit(label) && !by_label && !by_dataset)
      fail(function, (response ? "ordinate: unit \"" : "ordinate's denominator: unit \"") + label +
                         "\" is not known; add the units as dataset 164");
    if (by_label && by_dataset && std::abs(*by_label - *by_dataset) > kSameUnit * *by_dataset)
      fail(function, (response ? "ordinate: \"" : "ordinate's denominator: \"") + label +
                         "\" contradicts the units of dataset 164, line " + std::to_string(content_.units->line) +
                         "; correct one of them");
    if (!by_label && !by_dataset) si_assumed_ = true;
    return by_label.value_or(by_dataset.value_or(1.0));
  }

  // Those of the first function are the file's.
  std::vector<double> frequencies_of(const UffFunction& function) {
    std::vector<double> hz = function.abscissa;
    const UffAxis& axis = function.abscissa_axis;
    if (axis.data_type > 1 && axis.data_type != kUffFrequency)
      fail(function, "abscissa: data type " + std::to_string(axis.data_type) + " is no frequency (18)");
    if (axis.units == "rad/s")
      for (double& frequency : hz) frequency /= kTwoPi;
    else if (!names_no_unit(axis.units) && axis.units != "Hz" && axis.units != "HZ" && axis.units != "hz")
      fail(function, "abscissa: unit \"" + axis.units + "\" is not known; must be Hz or rad/s");
    for (std::size_t i = 0; i < hz.size(); ++i)
      if (hz[i] < 0.0 || (i > 0 && hz[i] <= hz[i - 1]))
        fail(function, "abscissa: frequencies must rise, from 0 up; point " + std::to_string(i + 1) + " does not");
    if (first_ == nullptr) {
      first_ = &function;
      result_.response.frequencies_hz = hz;
    }
    const std::vector<double>& first = result_.response.frequencies_hz;
    if (!std::equal(hz.begin(), hz.end(), first.begin(), first.end(),
                    [](double a, double b) { return std::abs(a - b) <= kSameFrequency * b; }))
      fail(function, "other frequencies than the function of line " + std::to_string(first_->line) +
                         "; give files of one measurement");
    if (function.response_node != first_->response_node || function.reference_node != first_->reference_node)
      fail(function, "nodes " + std::to_string(function.response_node) + " and " +
                         std::to_string(function.reference_node) + ", not " + std::to_string(first_->response_node) +
                         " and " + std::to_string(first_->reference_node) + " as in line " +
                         std::to_string(first_->line) + "; a file is of the tool's point alone");
    return first;
  }

  void leave_zero_out() {
    FrequencyResponse& response = result_.response;
    response.frequencies_hz.erase(response.frequencies_hz.begin());
    for (auto& row : response.receptance)
      for (ComplexValues& entry : row)
        if (!entry.empty()) entry.erase(entry.begin());
    for (auto& row : response.coherence)
      for (std::vector<double>& values : row)
        if (!values.empty()) values.erase(values.begin());
    if (response.frequencies_hz.empty()) fail(*first_, "has no frequency but 0 Hz");
    result_.notes.emplace_back("0 Hz is left out: no displacement follows from velocity or acceleration there");
  }

  const UffFile& content_;
  const std::string& file_;
  FrfFile result_;
  const UffFunction* first_ = nullptr;
  bool si_assumed_ = false, no_receptance_ = false;
};

}  // namespace

FrfFile read_frf(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".csv") return {parse_frf_csv(read_text_file(file), file.string()), {}};
  if (ending == ".uff" || ending == ".unv")
    return frf_of(parse_uff(read_text_file(file), file.string()), file.string());
  throw InputError(file.string(), 0, "a file of frequency responses must end in .uff, .unv or .csv");
}

FrfFile frf_of(const UffFile& content, const std::string& file) { return FrfReader(content, file).read(); }

UffFile uff_of(const FrequencyResponse& response) {
  require_sound_response(response);
  UffFile content{.units = UffUnits{}, .functions = {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force) {
      if (response.receptance[axis][force].empty()) continue;
      UffFunction function;
      const std::string entry = std::string("response ") + kAxisNames[axis] + " to force " + kAxisNames[force];
      function.id[0] = entry;
      if (response.added_decay_per_s > 0.0)
        function.id[1] = std::string(kDecayText) + csv_number(response.added_decay_per_s) + " 1/s, exponential window";
      if (response.force_error > 0.0)
        function.id[2] = std::string(kForceErrorText) + csv_number(response.force_error) + std::string(kForceErrorUnit);
      function.response_node = function.reference_node = 1;
      function.response_direction = static_cast<int>(axis) + 1;
      function.reference_direction = static_cast<int>(force) + 1;
      function.abscissa_axis = {kUffFrequency, "Frequency", "Hz"};
      function.ordinate = {kUffDisplacement, "Displacement", "m"};
      function.denominator = {kUffExcitationForce, "Force", "N"};
      function.abscissa = response.frequencies_hz;
      function.values = response.receptance[axis][force];
      content.functions.push_back(function);
      const std::vector<double>& coherence = response.coherence[axis][force];
      if (coherence.empty()) continue;
      function.id[0] = "coherence, " + entry;
      function.type = kUffCoherence;
      function.complex = false;
      function.ordinate = {kUffUnknown, "Coherence", ""};
      function.denominator = {};
      function.values.assign(coherence.begin(), coherence.end());
      content.functions.push_back(std::move(function));
    }
  return content;
}

}  // namespace stillcut
