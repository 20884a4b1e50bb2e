#include "drivers/files/gcode_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "drivers/files/path_builder.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

constexpr double kWidestGap = 1e-6;           // m
constexpr double kUprightAxis = 1.0 - 1e-12;  // cosine: within 1.4 µrad of Z
constexpr std::size_t kLongestComment = 200;  // LinuxCNC reads 255 characters a line
constexpr int kPlacesMm = 4, kPlacesFeed = 2;
constexpr std::int64_t kUnwritten = std::numeric_limits<std::int64_t>::min();

std::int64_t scaled(double value, int places) { return std::llround(value * std::pow(10.0, places)); }

// With the point always there: without it some controls count in micrometres.
std::string with_point(std::int64_t value, int places) {
  const std::string digits = std::to_string(std::abs(value));
  const std::string padded = std::string(static_cast<std::size_t>(places) + 1, '0').append(digits);
  const std::size_t point = padded.size() - static_cast<std::size_t>(places);
  const std::size_t first = std::min(padded.find_first_not_of('0'), point - 1);
  std::string text(value < 0 ? 1 : 0, '-');
  text.append(padded, first, point - first).append(1, '.').append(padded, point);
  text.erase(text.find_last_not_of('0') + 1);
  return text;
}

// A % would end the program, a parenthesis the comment, and a ; is how some controls show a line's end.
std::string comment(std::string_view text) {
  std::string line(1, '(');
  for (char c : text.substr(0, kLongestComment)) {
    if (c == '(') c = '[';
    if (c == ')') c = ']';
    line += c < ' ' || c > '~' || c == '%' || c == ';' ? ' ' : c;
  }
  return line.append(")\n");
}

std::int64_t feed_word(const PathMove& move) { return scaled(move.feed_rate * 60e3, kPlacesFeed); }
std::int64_t speed_word(const PathMove& move) { return std::llround(move.spindle_speed * 60.0 / (2.0 * pi)); }

bool is_meant(double rate, double most) { return std::isfinite(rate) && rate >= 0.0 && rate <= most; }

void check_moves(const ToolPath& path) {
  const auto fail = [](std::size_t i, const std::string& message) {
    throw std::invalid_argument("move " + std::to_string(i) + " " + message);
  };
  if (path.moves.empty()) throw std::invalid_argument("the path has no move");
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    const PathMove& move = path.moves[i];
    for (const Eigen::Vector3d& place : {move.from, move.to}) {
      if (!(place.cwiseAbs().maxCoeff() <= kFarthestCoordinate) || !place.allFinite())
        fail(i, "has a coordinate that is no number or beyond 100 m");
    }
    if (i > 0 && (move.from - path.moves[i - 1].to).norm() > kWidestGap) fail(i, "begins away from the end before it");
    if (!(move.tool_axis.normalized().z() >= kUprightAxis)) fail(i, "has a tilted tool; plain G-code keeps it along Z");
    const bool feeds = move.cutting || !std::isnan(move.feed_rate);
    if (feeds && (!is_meant(move.feed_rate, kFastestFeed) || feed_word(move) <= 0)) fail(i, "has no feed rate");
    const bool turns = move.cutting || !std::isnan(move.spindle_speed);
    if (turns && !is_meant(move.spindle_speed, kFastestSpindle * 2.0 * pi / 60.0)) fail(i, "has no spindle speed");
    if (move.cutting && speed_word(move) <= 0) fail(i, "has no spindle speed");
  }
}

// Writes a word where its value is another than before.
class WordWriter {
 public:
  explicit WordWriter(std::ostream& out) : out_(out) {}

  // Nothing at all when only the kind of motion would change.
  void go_to(const Eigen::Vector3d& to, std::string_view axes, const PathMove* move) {
    std::string words;
    for (const char axis : axes) {
      const auto i = static_cast<std::size_t>(axis - 'X');
      const std::int64_t value = scaled(to[static_cast<Eigen::Index>(i)] * 1e3, kPlacesMm);
      if (value != position_.at(i)) words.append({' ', axis}).append(with_point(value, kPlacesMm));
      position_.at(i) = value;
    }
    if (words.empty()) return;
    const bool feeds = move != nullptr && (move->cutting || !std::isnan(move->feed_rate));
    if (feeds && feed_word(*move) != feed_) {
      feed_ = feed_word(*move);
      words.append(" F").append(with_point(feed_, kPlacesFeed));
    }
    if (move != nullptr && !std::isnan(move->spindle_speed) && speed_word(*move) != speed_) {
      speed_ = speed_word(*move);
      words.append(" S").append(std::to_string(speed_));
    }
    const std::string_view motion = feeds ? "G1" : "G0";
    if (motion != motion_) out_ << motion << words << '\n';
    if (motion == motion_) out_ << std::string_view(words).substr(1) << '\n';
    motion_ = motion;
  }

  void start_spindle(std::int64_t speed) {
    speed_ = speed;
    out_ << "S" << speed << " M3\n";
  }

 private:
  std::ostream& out_;
  std::array<std::int64_t, 3> position_{kUnwritten, kUnwritten, kUnwritten};
  std::int64_t feed_ = kUnwritten, speed_ = kUnwritten;
  std::string_view motion_;
};

}  // namespace

void write_gcode(const ToolPath& path, std::ostream& out, const GcodeHeader& header) {
  check_moves(path);
  out << "%\n" << comment(header.name);
  for (const std::string& remark : header.remarks) out << comment(remark);
  out << comment("millimetres, feed in mm/min, spindle in rpm. Feed and spindle speed are set segment by segment")
      << "G21 G17 G90 G94\nG40 G49 G80\n";
  WordWriter words(out);
  const auto turning = std::find_if(path.moves.begin(), path.moves.end(), [](const PathMove& move) {
    return !std::isnan(move.spindle_speed) && speed_word(move) > 0;
  });
  const bool turns = turning != path.moves.end();
  if (turns) words.start_spindle(speed_word(*turning));
  words.go_to(path.moves.front().from, "XY", nullptr);
  words.go_to(path.moves.front().from, "Z", nullptr);
  auto section = header.sections.begin();
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    for (; section != header.sections.end() && section->first <= i; ++section) out << comment(section->second);
    words.go_to(path.moves[i].to, "XYZ", &path.moves[i]);
  }
  out << (turns ? "M5\n" : "") << "M30\n%\n";
}

}  // namespace stillcut
