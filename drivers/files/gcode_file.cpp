#include "drivers/files/gcode_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "drivers/files/arc_chords.hpp"
#include "drivers/files/gcode_vocabulary.hpp"
#include "drivers/files/gcode_words.hpp"
#include "drivers/files/path_builder.hpp"
#include "drivers/files/text_file.hpp"

namespace stillcut {
namespace {

constexpr double kUnsaid = std::numeric_limits<double>::quiet_NaN();
constexpr double kMillimetre = 1e-3;
constexpr double kInch = 25.4e-3;
constexpr std::string_view kAxes = "XYZ";

// What one line says, gathered first: the order of its words does not matter.
struct GcodeBlock {
  std::array<std::optional<double>, 26> values;  // by letter
  std::array<int, 6> of_group{-1, -1, -1, -1, -1, -1};
  bool dwell = false, blends = false, starts_spindle = false, stops_spindle = false, ends = false;

  [[nodiscard]] const std::optional<double>& value(char letter) const {
    return values.at(static_cast<std::size_t>(letter - 'A'));
  }
  [[nodiscard]] bool has_any(std::string_view letters) const {
    return std::any_of(letters.begin(), letters.end(), [this](char c) { return value(c).has_value(); });
  }
};

class GcodeReader {
 public:
  GcodeReader(const std::string& file, std::string name) : file_(file), builder_(file, std::move(name)) {}

  ToolPath read(std::string_view text) {
    while (!text.empty() && !ended_) {
      ++line_;
      const auto end = std::min(text.find('\n'), text.size());
      read_line(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    if (builder_.path().moves.empty()) builder_.fail(0, "holds no move; give a program with G0 and G1 moves");
    return std::move(builder_.path());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { builder_.fail(line_, message); }

  void read_line(std::string_view line) {
    if (is_percent(line)) {
      ended_ = begun_;
      begun_ = true;
      return;
    }
    read_gcode_words(line, file_, line_, words_);
    if (words_.empty()) return;
    begun_ = true;
    GcodeBlock block;
    for (const GcodeWord& word : words_) take(word, block);
    apply(block);
    move(block);
    if (block.stops_spindle) turns_ = false;  // M5 takes effect when the line's move is done
    ended_ = block.ends;
  }

  // The first % begins the program, the next one ends it.
  static bool is_percent(std::string_view line) {
    const auto at = line.find_first_not_of(" \t");
    return at != std::string_view::npos && line[at] == '%' &&
           line.find_first_not_of(" \t\r", at + 1) == std::string_view::npos;
  }

  void take(const GcodeWord& word, GcodeBlock& block) {
    const std::string name = word.letter + quoted_word(word.number);
    switch (word.letter) {
      case 'G':
        return take_g(word, name, block);
      case 'M':
        return take_m(word, name, block);
      case 'N':
      case 'T':
      case 'H':
      case 'D':
        return;
      case 'O':
        if (numbered_ || known_any())
          fail(name + ": a second program or a subprogram begins; give one program a file, without subprograms");
        numbered_ = true;
        return;
      default:
        break;
    }
    if (std::string_view("XYZIJRFSPQ").find(word.letter) == std::string_view::npos)
      fail(name + ": " + std::string(why_letter_is_refused(word.letter)));
    auto& value = block.values.at(static_cast<std::size_t>(word.letter - 'A'));
    if (value) fail(name + ": " + word.letter + " stands twice in the line; remove one");
    value = word.value;
  }

  static int tenths_of(double code) {
    const double tenths = std::round(code * 10.0);
    return std::abs(code * 10.0 - tenths) < 1e-6 && tenths >= 0.0 && tenths < 1e5 ? static_cast<int>(tenths) : -1;
  }

  void take_g(const GcodeWord& word, const std::string& name, GcodeBlock& block) const {
    const int tenths = tenths_of(word.value);
    if (tenths == 640) block.blends = true;
    if (tenths == 40) block.dwell = true;
    if (tenths == 40 || tenths == 170 || gcode_changes_nothing(tenths)) return;
    const int group = gcode_group(tenths);
    if (group == 0) fail(name + ": " + std::string(why_gcode_is_refused(tenths)));
    int& of_group = block.of_group.at(static_cast<std::size_t>(group));
    if (of_group >= 0 && of_group != tenths)
      fail(name + ": contradicts G" + std::to_string(of_group / 10) + " in the same line; remove one");
    of_group = tenths;
  }

  void take_m(const GcodeWord& word, const std::string& name, GcodeBlock& block) const {
    const int tenths = tenths_of(word.value);
    const int code = tenths % 10 == 0 ? tenths / 10 : -1;
    if (code == 2 || code == 30) {
      block.ends = true;
      return;
    }
    if (!mcode_changes_nothing(code)) fail(name + ": " + std::string(why_mcode_is_refused(code)));
    block.starts_spindle = block.starts_spindle || code == 3;
    block.stops_spindle = block.stops_spindle || code == 5;
    if (block.starts_spindle && block.stops_spindle) fail(name + ": M3 and M5 in one line; remove one");
  }

  // What holds from this line on.
  void apply(const GcodeBlock& block) {
    const auto [none, motion, units, distance, feed_mode, offset] = block.of_group;
    if (units >= 0) unit_ = units == 200 ? kInch : kMillimetre;
    if (distance >= 0) incremental_ = distance == 910;
    if (feed_mode >= 0 && (feed_mode == 950) != per_turn_) {
      per_turn_ = !per_turn_;
      feed_ = kUnsaid;
    }
    if (motion >= 0) motion_ = motion;
    choose_offset(offset);
    if (const auto& f = block.value('F')) {
      if (!(*f > 0.0)) fail("F: a feed must be above 0; give the feed rate");
      feed_ = *f * unit_;
      if (!per_turn_) (void)builder_.feed_rate(feed_, "F", line_);
    }
    if (const auto& s = block.value('S')) speed_ = builder_.spindle_speed(*s, "S", line_);
    if (block.starts_spindle) turns_ = true;
    if (block.value('P') && !block.dwell && !block.blends) fail("P: belongs to G4 or G64; remove it");
    if (block.value('Q') && !block.blends) fail("Q: belongs to G64; remove it");
  }

  // The first offset names the workpiece; another one shifts it by what only the control knows.
  void choose_offset(int offset) {
    if (offset < 0) return;
    const int before = offset_ < 0 && known_any() ? 540 : offset_;
    if (before >= 0 && offset != before)
      fail("G" + std::to_string(offset / 10) + ": the workpiece offset changes, by how much is not in the program; " +
           "split it there");
    offset_ = offset;
  }

  void move(const GcodeBlock& block) {
    if (block.dwell && block.has_any("XYZIJR")) fail("G4: a dwell with an axis word; give its time by P");
    const bool arc = motion_ == 20 || motion_ == 30;
    if (!arc && block.has_any("IJR")) fail("I, J and R belong to arcs (G2, G3); remove them or add the G word");
    if (!block.has_any("XYZIJR")) return;
    if (motion_ == 800) fail("an axis word while no motion is in effect; add G0, G1, G2 or G3");
    const bool known_before = known_all();
    const Eigen::Vector3d from = position_;
    const Eigen::Vector3d to = target(block);
    if (motion_ != 0 && !known_before)
      fail("a feed move before the position is known in X, Y and Z; begin with G0 moves that name all three");
    builder_.check_reach(to, line_);
    for (std::size_t i = 0; i < kAxes.size(); ++i) known_.at(i) = known_.at(i) || block.value(kAxes[i]).has_value();
    position_ = to;
    if (!known_before) return;
    const PathMotion motion{.feed_rate = motion_ == 0 ? kUnsaid : feed_rate(),
                            .spindle_speed = turns_.value_or(true) ? speed_ : 0.0};
    if (arc) return add_arc(block, from, to, motion);
    builder_.add(from, to, motion, line_);
  }

  [[nodiscard]] Eigen::Vector3d target(const GcodeBlock& block) const {
    Eigen::Vector3d to = position_;
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      const auto& value = block.value(kAxes[i]);
      if (!value) continue;
      if (incremental_ && !known_.at(i))
        fail(std::string(1, kAxes[i]) + ": an incremental move before the position is known; begin with G90");
      double& coordinate = to[static_cast<Eigen::Index>(i)];
      coordinate = *value * unit_ + (incremental_ ? coordinate : 0.0);
    }
    return to;
  }

  [[nodiscard]] double feed_rate() const {
    if (std::isnan(feed_)) fail("a feed move before its feed is known; add F");
    if (!per_turn_) return builder_.feed_rate(feed_, "F", line_);
    if (std::isnan(speed_)) fail("a feed per turn (G95) before the spindle speed is known; add S, or post G94");
    return builder_.feed_rate(feed_ * speed_ * 60.0 / (2.0 * std::numbers::pi), "F", line_);
  }

  void add_arc(const GcodeBlock& block, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
               const PathMotion& motion) {
    const auto& radius = block.value('R');
    if (!radius && !block.has_any("IJ")) fail("an arc without its centre; give I and J, or R");
    if (radius && block.has_any("IJ")) fail("an arc by centre and by radius; remove I and J, or R");
    if (radius && !block.has_any("XY")) fail("an arc by R without its end; give X and Y");
    try {
      const bool clockwise = motion_ == 20;
      const Eigen::Vector2d centre =
          from.head<2>() + unit_ * Eigen::Vector2d(block.value('I').value_or(0.0), block.value('J').value_or(0.0));
      const PathArc arc =
          radius ? arc_of_radius(from, to, *radius * unit_, clockwise) : arc_about(from, to, centre, clockwise);
      const std::size_t count = chord_count(arc);
      Eigen::Vector3d before = from;
      for (std::size_t i = 1; i <= count; ++i) {
        const Eigen::Vector3d next = point_on_arc(arc, static_cast<double>(i) / static_cast<double>(count));
        builder_.add(before, next, motion, line_);
        before = next;
      }
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
  }

  [[nodiscard]] bool known_all() const { return known_[0] && known_[1] && known_[2]; }
  [[nodiscard]] bool known_any() const { return known_[0] || known_[1] || known_[2]; }

  const std::string& file_;
  PathBuilder builder_;
  std::vector<GcodeWord> words_;
  int line_ = 0;
  bool begun_ = false, ended_ = false, numbered_ = false;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  std::array<bool, 3> known_{};
  int motion_ = 800;  // in tenths; G80: none
  int offset_ = -1;
  double unit_ = kMillimetre;
  bool incremental_ = false, per_turn_ = false;
  double feed_ = kUnsaid;      // m a minute, or a turn
  double speed_ = kUnsaid;     // rad/s
  std::optional<bool> turns_;  // empty: neither M3 nor M5 yet; S then says the speed
};

}  // namespace

ToolPath parse_gcode(std::string_view text, const std::string& file) {
  return GcodeReader(file, std::filesystem::path(file).stem().string()).read(text);
}

ToolPath read_gcode(const std::filesystem::path& file) { return parse_gcode(read_text_file(file), file.string()); }

}  // namespace stillcut
