#include "models/mode_tracking.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "tests/models/moving_modes.hpp"

namespace stillcut {
namespace {

using test::KnownMap;
using test::TapErrors;

// Modes that bear another number than most of their kind, or the number of another kind.
int misnumbered(const KnownMap& known, const ModeTracks& tracks) {
  std::map<int, std::map<int, int>> numbers_of, kinds_of;
  for (std::size_t p = 0; p < known.mode.size(); ++p)
    for (std::size_t m = 0; m < known.mode[p].size(); ++m) {
      ++numbers_of[known.mode[p][m]][tracks.number[p][m]];
      ++kinds_of[tracks.number[p][m]][known.mode[p][m]];
    }
  const auto most = [](const std::map<int, int>& counts) {
    return std::max_element(counts.begin(), counts.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  };
  int wrong = 0;
  for (std::size_t p = 0; p < known.mode.size(); ++p)
    for (std::size_t m = 0; m < known.mode[p].size(); ++m) {
      const int kind = known.mode[p][m], number = tracks.number[p][m];
      if (most(numbers_of[kind]) != number || most(kinds_of[number]) != kind) ++wrong;
    }
  return wrong;
}

int modes_in(const KnownMap& known) {
  int count = 0;
  for (const auto& modes : known.mode) count += static_cast<int>(modes.size());
  return count;
}

Posture posture_at(double x, std::vector<Mode> modes) {
  Posture posture;
  posture.id = "at " + std::to_string(x);
  posture.position = {x, 0.0, 0.0};
  posture.modes = std::move(modes);
  sort_modes(posture.modes);
  return posture;
}

TEST(ModalAssurance, IsTheSquaredCosineWhateverSignsAndLengths) {
  const Mode a{1.0, 0.1, 1.0, {1, 0, 0}};
  EXPECT_NEAR(modal_assurance(a, {1.0, 0.1, 1.0, {-0.6, 0.8, 0}}), 0.36, 1e-15);
  EXPECT_NEAR(modal_assurance(a, {1.0, 0.1, 1.0, {0.5, 0, 0}}), 1.0, 1e-15);
  EXPECT_NEAR(modal_assurance(a, {1.0, 0.1, 1.0, {0, 0, 1}}), 0.0, 1e-15);
}

TEST(ModeTracking, FollowsModesThatCross) {
  DynamicsMap map;
  for (int i = 0; i <= 10; ++i) {
    const double x = 0.1 * i;
    map.postures.push_back(posture_at(
        x, {{kTwoPi * (20.0 + 10.0 * x), 0.03, 1e6, {1, 0, 0}}, {kTwoPi * (29.0 - 10.0 * x), 0.03, 1e6, {0, 1, 0}}}));
  }
  const ModeTracks tracks = track_modes(map);
  ASSERT_EQ(tracks.count, 2);
  for (std::size_t p = 0; p < map.postures.size(); ++p)
    for (std::size_t m = 0; m < 2; ++m) {
      // In the mean the one along y is the lower: 24 against 25 Hz.
      const bool along_y = map.postures[p].modes[m].direction[1] == 1.0;
      EXPECT_EQ(tracks.number[p][m], along_y ? 1 : 2) << p;
    }
  EXPECT_EQ(tracks.number.front(), (std::vector<int>{2, 1}));
  EXPECT_EQ(tracks.number.back(), (std::vector<int>{1, 2}));
}

TEST(ModeTracking, AMissedModeIsMissingAndAFalseOneStandsAlone) {
  DynamicsMap map;
  for (int i = 0; i < 7; ++i) {
    std::vector<Mode> modes{{kTwoPi * (20.0 + i), 0.03, 1e6, {1, 0, 0}}, {kTwoPi * 60.0, 0.03, 1e6, {0, 1, 0}}};
    if (i == 3) modes[0] = {kTwoPi * 33.0, 0.03, 1e6, {0, 0.1, 1}};  // another one instead
    map.postures.push_back(posture_at(0.1 * i, modes));
  }
  const ModeTracks tracks = track_modes(map);
  ASSERT_EQ(tracks.count, 3);
  for (std::size_t p = 0; p < 7; ++p)
    EXPECT_EQ(tracks.number[p], (p == 3 ? std::vector<int>{2, 3} : std::vector<int>{1, 3})) << p;
  EXPECT_EQ(tracks.found(1), 6);
  EXPECT_EQ(tracks.found(2), 1);
  EXPECT_EQ(tracks.found(3), 7);
}

TEST(ModeTracking, NumbersRandomMapsAsTheyWereMade) {
  int wrong = 0, all = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const auto modes = test::moving_modes(6, 0.5, 0.3, random);
    const KnownMap known =
        test::tapped_map(modes, test::random_places(25, random), {.frequency = 0.005, .direction = 0.05}, random);
    wrong += misnumbered(known, track_modes(known.map));
    all += modes_in(known);
  }
  EXPECT_LE(wrong, all / 200);
}

TEST(ModeTracking, NumbersThemThoughSomeAreMissedAndSomeFalse) {
  int wrong = 0, all = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const auto modes = test::moving_modes(6, 0.5, 0.3, random);
    const TapErrors errors{.frequency = 0.005, .direction = 0.05, .missed = 0.08, .added = 0.08};
    const KnownMap known = test::tapped_map(modes, test::random_places(25, random), errors, random);
    wrong += misnumbered(known, track_modes(known.map));
    all += modes_in(known);
  }
  EXPECT_LE(wrong, all / 40);
}

TEST(ModeTracking, WithoutPlacesFollowsWhatIsAlike) {
  int wrong = 0, all = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const auto modes = test::moving_modes(5, 0.6, 0.15, random);
    const KnownMap known =
        test::tapped_map(modes, test::random_places(20, random), {.frequency = 0.005, .direction = 0.05}, random);
    DynamicsMap nowhere = known.map;
    for (Posture& posture : nowhere.postures) posture.position = {};
    wrong += misnumbered(known, track_modes(nowhere, {.places_known = false}));
    all += modes_in(known);
  }
  EXPECT_LE(wrong, all / 50);
}

TEST(ModeTracking, TakesMapsOfNoneAndOnePostureAndRefusesUnphysicalModes) {
  EXPECT_EQ(track_modes({}).count, 0);
  DynamicsMap one;
  one.postures.push_back(posture_at(0.0, {{100.0, 0.03, 1e6, {1, 0, 0}}, {200.0, 0.03, 1e6, {1, 0, 0}}}));
  EXPECT_EQ(track_modes(one).number, (std::vector<std::vector<int>>{{1, 2}}));
  one.postures[0].modes[1].stiffness = 0.0;
  EXPECT_THROW(track_modes(one), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
