// Proposals for a dynamics map: kept apart, and taken over only where the map is still the one they were made for.
#include "drivers/files/map_proposals_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/input_error.hpp"
#include "models/machining.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

const MapProposal kHome{"a, b", 2, 752.5, 744.25, 1.25, 7, ProposalStatus::open, "7 times, \"quoted\""};

class ProposedMap : public TempFolder {
 public:
  ProposedMap() {
    Posture posture;
    posture.id = "a, b";
    for (const double hz : {12.0, 752.5, 795.0}) posture.modes.push_back({kTwoPi * hz, 0.02, 1e7, {1, 0, 0}});
    map.postures.push_back(posture);
    write_dynamics_map(path(), map);
  }
  DynamicsMap map;
};

TEST(MapProposals, ComeBackAsTheyWereWritten) {
  const TempFolder folder;
  EXPECT_TRUE(read_map_proposals(folder.path()).empty());
  MapProposal rejected = kHome;
  rejected.mode = 1;
  rejected.status = ProposalStatus::rejected;
  write_map_proposals(folder.path(), {kHome, rejected});
  const auto read = read_map_proposals(folder.path());
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].id(), "a, b/2");
  EXPECT_EQ(read[0].frequency_hz, kHome.frequency_hz);
  EXPECT_EQ(read[0].proposed_frequency_hz, kHome.proposed_frequency_hz);
  EXPECT_EQ(read[0].frequency_hz_se, kHome.frequency_hz_se);
  EXPECT_EQ(read[0].observations, kHome.observations);
  EXPECT_EQ(read[0].status, ProposalStatus::open);
  EXPECT_EQ(read[0].evidence, kHome.evidence);
  EXPECT_EQ(read[1].status, ProposalStatus::rejected);
}

TEST(MapProposals, NameFileAndLineOfWhatIsWrong) {
  const TempFolder folder;
  const auto message = [&](const std::string& row) {
    (void)folder.write(
        "proposals.csv",
        "posture,mode,frequency_hz,proposed_frequency_hz,frequency_hz_se,observations,status,evidence\n" + row);
    return message_of<InputError>([&] { (void)read_map_proposals(folder.path()); });
  };
  EXPECT_EQ(message("1,2,750,740,1,7,open,\n"), "");
  EXPECT_THAT(message("1,2.5,750,740,1,7,open,\n"), HasSubstr("proposals.csv:2: mode: 2.5 is no whole number"));
  EXPECT_THAT(message("1,0,750,740,1,7,open,\n"), HasSubstr("mode: 0 is out of range"));
  EXPECT_THAT(message("1,2,750,-740,1,7,open,\n"), HasSubstr("proposed_frequency_hz: -740 is out of range"));
  EXPECT_THAT(message("1,2,750,740,1,7,maybe,\n"), HasSubstr("status: \"maybe\" is no status"));
  EXPECT_THAT(message("1,2,750,740,1,7,open,\n1,2,750,741,1,7,open,\n"),
              HasSubstr("proposals.csv:3: mode: 1/2 stands twice"));
}

TEST(MapProposals, ChangeOneFrequencyOfTheMapAndNothingElse) {
  const ProposedMap folder;
  const DynamicsMap changed = with_proposals(folder.map, {kHome}, folder.path());
  for (std::size_t m = 0; m < 3; ++m) {
    Mode expected = folder.map.postures[0].modes[m];
    if (m == 1) expected.natural_frequency = kTwoPi * 744.25;
    const Mode& mode = changed.postures[0].modes[m];
    EXPECT_EQ(mode.natural_frequency, expected.natural_frequency);
    EXPECT_EQ(mode.damping_ratio, expected.damping_ratio);
    EXPECT_EQ(mode.stiffness, expected.stiffness);
    EXPECT_EQ(mode.direction, expected.direction);
  }
}

TEST(MapProposals, AreRefusedByAMapThatHasChanged) {
  const ProposedMap folder;
  const auto message = [&](auto spoil) {
    MapProposal one = kHome;
    spoil(one);
    return message_of<InputError>([&] { (void)with_proposals(folder.map, {one}, folder.path()); });
  };
  EXPECT_THAT(message([](MapProposal& one) { one.frequency_hz = 752.4; }),
              HasSubstr("a, b/2: has 752.5 Hz in the map, not 752.4 as when it was proposed; refine again"));
  EXPECT_THAT(message([](MapProposal& one) { one.mode = 4; }), HasSubstr("a, b/4: is no longer in the map"));
  EXPECT_THAT(message([](MapProposal& one) { one.posture = "c"; }), HasSubstr("c/2: is no longer in the map"));
}

TEST(MapProposals, LeaveTheOldModesBesideTheNew) {
  const ProposedMap folder;
  const auto content = [&](const char* name) {
    std::ifstream in(folder.path() / name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string before = content("modes.csv");
  const DynamicsMap changed = with_proposals(folder.map, {kHome}, folder.path());
  EXPECT_EQ(replace_modes(folder.path(), changed).filename(), "modes.csv.1");
  EXPECT_EQ(content("modes.csv.1"), before);
  EXPECT_NEAR(read_dynamics_map(folder.path()).postures[0].modes[1].natural_frequency, kTwoPi * 744.25, 1e-9);
  EXPECT_EQ(replace_modes(folder.path(), folder.map).filename(), "modes.csv.2");
  EXPECT_EQ(content("modes.csv"), before);
}

}  // namespace
}  // namespace stillcut
