#include "tools/tap_recordings.hpp"

#include <algorithm>

#include "drivers/files/input_error.hpp"
#include "tools/tap_dialog.hpp"

namespace stillcut {
namespace {

struct NamedRecording {
  std::string file;
  std::optional<HammerDirection> direction;
};

NamedRecording parse_name(const std::string& text, double sense) {
  if (text.find('=') != 1) return {text, {}};
  auto direction = parse_direction(text.substr(0, 1));
  if (!direction) return {text, {}};
  direction->sense = sense;
  return {text.substr(2), direction};
}

// The hammer of a recording, by its file, its name or the default.
HammerDirection hammer_of(const RecordedTaps& taps, const NamedRecording& named,
                          const std::optional<HammerDirection>& by_default) {
  if (named.direction && taps.direction && *named.direction != *taps.direction)
    throw InputError(named.file, 0,
                     "tells of a hammer towards " + direction_name(*taps.direction) + ", not " +
                         direction_name(*named.direction) + "; leave its direction out of the command");
  if (taps.direction) return *taps.direction;
  if (named.direction) return *named.direction;
  if (by_default) return *by_default;
  throw InputError(named.file, 0, "does not tell the hammer's axis; give --axis x, or x=" + named.file);
}

}  // namespace

std::optional<HammerDirection> parse_direction(std::string text) {
  HammerDirection hammer;
  if (text.starts_with('-') || text.starts_with('+')) {
    hammer.sense = text.front() == '-' ? -1.0 : 1.0;
    text.erase(0, 1);
  }
  const std::size_t axis = std::string_view("xyz").find(text);
  if (text.size() != 1 || axis == std::string_view::npos) return {};
  hammer.axis = static_cast<int>(axis);
  return hammer;
}

std::vector<RecordedDirection> read_directions(const NamedRecordings& all, std::vector<std::string>& notes) {
  std::vector<RecordedDirection> directions;
  for (const std::string& name : all.names) {
    const NamedRecording named = parse_name(name, all.sense);
    TapFile content = read_tap_file(named.file, all.channels);
    for (const std::string& note : content.notes) notes.push_back(std::string(named.file).append(": ").append(note));
    for (RecordedTaps& taps : content.taps) {
      const HammerDirection hammer = hammer_of(taps, named, all.default_direction);
      auto same = std::ranges::find_if(directions, [&](const auto& d) { return d.hammer.axis == hammer.axis; });
      if (same == directions.end()) {
        directions.push_back({hammer, {}, {}});
        same = directions.end() - 1;
      }
      if (same->hammer != hammer)
        throw InputError(named.file, 0,
                         "is struck towards " + direction_name(hammer) + ", others towards " +
                             direction_name(same->hammer) + "; estimate them apart");
      same->recordings.push_back(std::move(taps.recording));
      same->files.push_back(named.file);
    }
  }
  return directions;
}

}  // namespace stillcut
