#include "drivers/files/cl_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/files/cl_statements.hpp"
#include "drivers/files/path_builder.hpp"
#include "drivers/files/text_file.hpp"

namespace stillcut {
namespace {

constexpr double kNotSaid = std::numeric_limits<double>::quiet_NaN();
constexpr double kClMillimetre = 1e-3;
constexpr double kClInch = 25.4e-3;
constexpr double kShortestAxis = 1e-6;

// What tells the operator, the tool, the coolant or the screen, and moves no tool.
constexpr std::array<std::string_view, 25> kIdleWords{
    "PARTNO", "PPRINT", "REMARK", "TPRINT", "MACHIN", "END-OF-PATH", "TLDATA", "CUTTER", "LOADTL",
    "LOAD",   "TOOLNO", "SELECT", "SELCTL", "COOLNT", "PAINT",       "OPSKIP", "OPSTOP", "STOP",
    "DELAY",  "SEQNO",  "DISPLY", "INTOL",  "OUTTOL", "TOLER",       "END"};

constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kRefusedWords{{
    {"CIRCLE",
     "arcs are not read, as their sense is not certain; let the CAM system write lines only (NX: Motion "
     "Output, Line)"},
    {"HELIX", "arcs are not read; let the CAM system write lines only"},
    {"CYCLE", "cycles are not read; let the CAM system write their moves"},
    {"CUTCOM", "the tool's radius moves the path; let the CAM system write the way of the tool's tip"},
    {"INSERT", "hands the controller text of its own, which may move the tool; remove it"},
    {"PREFUN", "hands the controller a G word of its own, which may move the tool; remove it"},
    {"GOHOME", "goes to a place that the file does not tell; remove it"},
    {"RETRCT", "goes to a place that the file does not tell; remove it or give a GOTO"},
    {"TRACUT", "moves the path; let the CAM system write it where it is cut"},
    {"ORIGIN", "moves the path; let the CAM system write it where it is cut"},
    {"ROTATE", "turns the workpiece; let the CAM system write the tool's axis in GOTO"},
    {"CALL", "calls a macro; let the CAM system write its moves"},
}};

std::string in_quotes(const std::string& item) {
  std::string quoted(1, '"');
  return quoted.append(quoted_word(item)).append(1, '"');
}

class ClReader {
 public:
  ClReader(const std::string& file, std::string name) : file_(file), builder_(file, std::move(name)) {}

  ToolPath read(std::string_view text) {
    for (int line = 0; next_cl_statement(text, file_, line, said_) && said_.word != "FINI";) take();
    if (builder_.path().moves.empty()) builder_.fail(0, "holds no move; give GOTO statements");
    return std::move(builder_.path());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    builder_.fail(said_.line, quoted_word(said_.word) + ": " + message);
  }

  void take() {
    const std::string& word = said_.word;
    if (word == "GOTO") return go_to();
    if (word == "GODLTA") return go_by();
    if (word == "FROM") return go_from();
    if (word == "RAPID") return void(rapid_ = true);
    if (word == "FEDRAT") return take_feed();
    if (word == "SPINDL") return take_spindle();
    if (word == "UNITS") return take_unit();
    if (word == "MULTAX") return take_axes_mode();
    if (word == "MSYS") return check_identity();
    if (word == "TOOL PATH") return begin_path();
    if (word == "CUTCOM" && said_.items == std::vector<std::string>{"OFF"}) return;
    if (std::find(kIdleWords.begin(), kIdleWords.end(), word) != kIdleWords.end()) return;
    const auto* const refused =
        std::find_if(kRefusedWords.begin(), kRefusedWords.end(), [&](const auto& r) { return r.first == word; });
    if (refused != kRefusedWords.end()) fail(std::string(refused->second));
    fail(
        "is not known to leave the tool's way as written; remove it or let the CAM system write GOTO alone "
        "(docs/tool-paths.md lists the words)");
  }

  [[nodiscard]] std::optional<double> number_in(const std::string& item) const {
    const bool plus = item.size() > 1 && item[0] == '+' && item[1] != '-';
    double value = 0.0;
    const char* const last = item.data() + item.size();
    const auto [end, error] = std::from_chars(item.data() + (plus ? 1 : 0), last, value);
    if (error != std::errc{} || end != last || !std::isfinite(value)) return std::nullopt;
    return value;
  }

  [[nodiscard]] double number(std::size_t i) const {
    const std::string& item = said_.items.at(i);
    const auto value = number_in(item);
    if (!value) fail(in_quotes(item) + " is no number; give one with a dot as decimal point");
    return *value;
  }

  [[nodiscard]] Eigen::Vector3d numbers_from(std::size_t i) const { return {number(i), number(i + 1), number(i + 2)}; }

  // Position, and the tool's axis where the statement names one.
  Eigen::Vector3d place() {
    if (said_.items.size() != 3 && said_.items.size() != 6)
      fail("has " + std::to_string(said_.items.size()) + " items; give x,y,z or x,y,z,i,j,k");
    Eigen::Vector3d at = unit_ * numbers_from(0);
    builder_.check_reach(at, said_.line);
    if (said_.items.size() == 6) {
      const Eigen::Vector3d axis = numbers_from(3);
      if (!(axis.norm() > kShortestAxis)) fail("the tool's axis has no length; give i,j,k from the tip to the holder");
      axis_ = axis.stableNormalized();
    }
    return at;
  }

  void begin_at(const Eigen::Vector3d& at) {
    position_ = at;
    axis_there_ = axis_;
    begins_ = false;
  }

  void begin_path() {
    axis_ = Eigen::Vector3d::UnitZ();
    begins_ = true;
    if (!named_ && !said_.items.empty() && !said_.items[0].empty()) builder_.path().name = said_.items[0];
    named_ = true;
  }

  // Between the paths of a file the tool gets there somehow: not by cutting.
  void go_from() {
    const bool rapid = rapid_;
    begins_ = true;
    move_to(place());
    rapid_ = rapid;
  }

  void go_to() { move_to(place()); }

  void go_by() {
    if (said_.items.size() != 3) fail("has " + std::to_string(said_.items.size()) + " items; give dx,dy,dz");
    if (!position_ || begins_) fail("a step before the position is known; begin with FROM or GOTO");
    move_to(*position_ + unit_ * numbers_from(0));
  }

  void move_to(const Eigen::Vector3d& to) {
    const bool cuts = !std::exchange(rapid_, false) && !begins_;
    if (position_) {
      builder_.add(*position_, to,
                   {.feed_rate = cuts ? feed_rate() : kNotSaid,
                    .spindle_speed = speed_,
                    .tool_axis = axis_,
                    .axis_from = axis_there_},
                   said_.line);
    }
    begin_at(to);
  }

  [[nodiscard]] double feed_rate() const {
    if (std::isnan(feed_)) fail("a feed move before its feed is known; give FEDRAT before it, or RAPID");
    if (!per_turn_) return builder_.feed_rate(feed_, "FEDRAT", said_.line);
    if (!(speed_ > 0.0))
      fail("a feed per turn before the spindle speed is known; give SPINDL, or FEDRAT by the minute");
    return builder_.feed_rate(feed_ * speed_ * 60.0 / (2.0 * std::numbers::pi), "FEDRAT", said_.line);
  }

  void take_feed() {
    std::optional<double> value;
    double unit = unit_;
    bool per_turn = false;
    for (std::size_t i = 0; i < said_.items.size(); ++i) {
      const std::string& item = said_.items[i];
      if (item == "MMPM" || item == "MMPR" || item == "IPM" || item == "IPR") {
        unit = item.starts_with("MM") ? kClMillimetre : kClInch;
        per_turn = item.back() == 'R';
        continue;
      }
      if (value) fail(in_quotes(item) + " is no unit of feed; give MMPM, IPM, MMPR or IPR");
      value = number(i);
    }
    if (!value || !(*value > 0.0)) fail("a feed must be above 0; give the feed rate");
    feed_ = *value * unit;
    per_turn_ = per_turn;
    if (!per_turn) (void)builder_.feed_rate(feed_, "FEDRAT", said_.line);
  }

  void take_spindle() {
    for (std::size_t i = 0; i < said_.items.size(); ++i) {
      const std::string& item = said_.items[i];
      if (item == "CCLW") fail("an anti-clockwise spindle would swap up and down milling; let it turn CLW");
      if (item == "RPM" || item == "CLW" || item == "ON" || item == "OFF") continue;
      if (!number_in(item)) fail(in_quotes(item) + " is not known; give RPM, the speed and CLW, or OFF");
      programmed_ = builder_.spindle_speed(number(i), "SPINDL", said_.line);
    }
    const bool off = std::find(said_.items.begin(), said_.items.end(), "OFF") != said_.items.end();
    speed_ = off ? 0.0 : programmed_;
  }

  void take_unit() {
    const std::string unit = said_.items.size() == 1 ? said_.items[0] : "";
    if (unit != "MM" && unit != "INCH" && unit != "INCHES") fail("is not known; give UNITS/MM or UNITS/INCHES");
    unit_ = unit == "MM" ? kClMillimetre : kClInch;
  }

  void take_axes_mode() {
    const std::string mode = said_.items.empty() ? "ON" : said_.items[0];
    if (said_.items.size() > 1 || (mode != "ON" && mode != "OFF")) fail("is not known; give MULTAX/ON or MULTAX/OFF");
    if (mode == "OFF") axis_ = Eigen::Vector3d::UnitZ();
  }

  // Origin, x axis and y axis of the system that coordinates are given in.
  void check_identity() const {
    constexpr std::array kIdentity{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    bool same = said_.items.size() == kIdentity.size();
    for (std::size_t i = 0; same && i < kIdentity.size(); ++i) same = std::abs(number(i) - kIdentity[i]) < 1e-6;
    if (!same)
      fail(
          "a coordinate system other than the workpiece's; set it to 0,0,0, 1,0,0, 0,1,0 (NX: the MCS to the absolute "
          "origin) and write the path again");
  }

  const std::string& file_;
  PathBuilder builder_;
  ClStatement said_;
  std::optional<Eigen::Vector3d> position_;
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ(), axis_there_ = axis_;  // in effect; where the tool is
  bool begins_ = true, rapid_ = false, named_ = false, per_turn_ = false;
  double unit_ = kClMillimetre;
  double feed_ = kNotSaid;                           // m a minute, or a turn
  double speed_ = kNotSaid, programmed_ = kNotSaid;  // rad/s, now and when the spindle turns
};

}  // namespace

ToolPath parse_cutter_locations(std::string_view text, const std::string& file) {
  return ClReader(file, std::filesystem::path(file).stem().string()).read(text);
}

ToolPath read_cutter_locations(const std::filesystem::path& file) {
  return parse_cutter_locations(read_text_file(file), file.string());
}

}  // namespace stillcut
