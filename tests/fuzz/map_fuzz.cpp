// Dynamics maps: postures.csv, a line ====, modes.csv.
#include <cmath>

#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace stillcut;

namespace {

constexpr std::string_view kBetween = "====\n";

// A unit is converted on the way: the last bit may differ.
template <class Numbers>
bool close(const Numbers& a, const Numbers& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) <= 1e-14 * std::abs(a[i]))) return false;
  return true;
}

void check_map(const DynamicsMap& map) {
  const auto [postures, modes] = dynamics_map_text(map);
  DynamicsMap again;
  try {
    again = parse_dynamics_map(postures, modes, "again");
  } catch (const InputError& error) {
    require_that(false, error.what());
  }
  require_that(again.has_joints == map.has_joints && again.postures.size() == map.postures.size(), "as many postures");
  for (std::size_t i = 0; i < map.postures.size(); ++i) {
    const Posture &a = map.postures[i], &b = again.postures[i];
    require_that(a.id == b.id && close(a.joints, b.joints) && close(a.position, b.position), "the same posture");
    require_that(a.modes.size() == b.modes.size(), "as many modes");
    for (std::size_t k = 0; k < a.modes.size(); ++k) {
      const Mode &m = a.modes[k], &n = b.modes[k];
      require_that(m.damping_ratio == n.damping_ratio && m.stiffness == n.stiffness && m.direction == n.direction &&
                       close(std::array{m.natural_frequency}, std::array{n.natural_frequency}),
                   "the same mode");
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = text_of(data, size);
  const auto middle = text.find(kBetween);
  if (middle == std::string_view::npos) return 0;
  DynamicsMap map;
  try {
    map = parse_dynamics_map(text.substr(0, middle), text.substr(middle + kBetween.size()), "map");
  } catch (const InputError&) {
    return 0;
  }
  check_map(map);
  return 0;
}
