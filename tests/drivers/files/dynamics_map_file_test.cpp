#include "drivers/files/dynamics_map_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

const std::string kPostures =
    "posture,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg,x_mm,y_mm,z_mm\n"
    "1,0,-90,90,0,45,180,1000,-200,50.5\n"
    "A2,10,-90,90,0,45,180,1100,-200,50.5\n";
const std::string kHexapodPostures = "posture,x_mm,y_mm,z_mm\n1,0,0,0\nA2,100,0,0\n";
const std::string kModes =
    "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
    "A2,1,12.5,0.03,1e6,1,0,0\n"
    "1,2,500,0.015,2e7,0,0.6,0.8\n"
    "1,1,17.54,0.02,1.5e6,0.6,0,-0.8\n";

DynamicsMap read(const std::string& postures, const std::string& modes) {
  const TempFolder folder;
  (void)folder.write("postures.csv", postures);
  (void)folder.write("modes.csv", modes);
  return read_dynamics_map(folder.path());
}

std::string error_of(const std::string& postures, const std::string& modes) {
  const std::string message = message_of<InputError>([&] { read(postures, modes); });
  return message.substr(message.rfind('/') + 1);
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(DynamicsMapFile, ReadsPosturesAndModesInSiUnits) {
  const DynamicsMap map = read(kPostures, kModes);
  EXPECT_TRUE(map.has_joints);
  ASSERT_EQ(map.postures.size(), 2U);
  const Posture& posture = map.postures[0];
  EXPECT_EQ(posture.id, "1");
  EXPECT_EQ(map.postures[1].id, "A2");
  EXPECT_NEAR(posture.joints[1], -pi / 2, 1e-15);
  EXPECT_NEAR(posture.joints[5], pi, 1e-15);
  EXPECT_NEAR(posture.position[0], 1.0, 1e-15);
  EXPECT_NEAR(posture.position[2], 0.0505, 1e-17);
  ASSERT_EQ(posture.modes.size(), 2U);
  EXPECT_NEAR(posture.modes[0].natural_frequency, 17.54 * 2 * pi, 1e-13);
  EXPECT_EQ(posture.modes[0].damping_ratio, 0.02);
  EXPECT_EQ(posture.modes[0].stiffness, 1.5e6);
  EXPECT_EQ(posture.modes[0].direction, (std::array<double, 3>{0.6, 0.0, -0.8}));
}

TEST(DynamicsMapFile, SortsModesByFrequency) {
  const DynamicsMap map = read(kPostures, kModes);
  EXPECT_LT(map.postures[0].modes[0].natural_frequency, map.postures[0].modes[1].natural_frequency);
}

TEST(DynamicsMapFile, ReadsAMachineWithoutJoints) {
  const DynamicsMap map = read(kHexapodPostures, kModes);
  EXPECT_FALSE(map.has_joints);
  EXPECT_EQ(map.postures[1].position, (std::array<double, 3>{0.1, 0.0, 0.0}));
}

TEST(DynamicsMapFile, NormalisesADirectionThatIsRounded) {
  const DynamicsMap map = read(kPostures, replaced(kModes, "0,0.6,0.8", "0,0.61,0.81"));
  const auto& u = map.postures[0].modes[1].direction;
  EXPECT_NEAR(std::hypot(u[0], u[1], u[2]), 1.0, 1e-15);
  EXPECT_NEAR(u[1] / u[2], 0.61 / 0.81, 1e-15);
}

TEST(DynamicsMapFile, IgnoresColumnsOfTheUsersOwn) {
  const std::string text = "posture,x_mm,y_mm,z_mm,remark\n1,0,0,0,\"near, low\"\nA2,1,0,0,\n";
  EXPECT_EQ(read(text, kModes).postures.size(), 2U);
}

TEST(DynamicsMapFile, NamesFileLineAndColumnOfEveryMistake) {
  struct Mistake {
    std::string postures, modes, message;
  };
  const auto postures = [](std::string_view from, std::string_view to, const char* message) {
    return Mistake{replaced(kPostures, from, to), kModes, message};
  };
  const auto modes = [](std::string_view from, std::string_view to, const char* message) {
    return Mistake{kPostures, replaced(kModes, from, to), message};
  };
  const Mistake mistakes[] = {
      {"", kModes, "postures.csv: is empty"},
      {kPostures, "", "modes.csv: is empty"},
      {"posture,x_mm,y_mm,z_mm\n", kModes, "postures.csv: holds no posture"},
      postures("j3_deg,", "", "postures.csv:2: has 10 fields"),
      postures("A2", "1", "postures.csv:3: posture: 1 stands twice"),
      postures("A2,10", "A2,0", "postures.csv:3: posture: A2 is at the same place as 1"),
      postures("A2", " ", "postures.csv:3: posture: is empty"),
      postures("-90", "minus", "postures.csv:2: j2_deg: \"minus\" is no number"),
      postures("-90", "1e9", "postures.csv:2: j2_deg: 1e+09 is out of range"),
      postures("j1_deg", "J1_deg", "postures.csv:1: J1_deg: unknown column; did you mean j1_deg?"),
      postures("z_mm", "height", "postures.csv:1: z_mm: the header lacks this column"),
      {kPostures + "3,20,0,0,0,0,0,0,0,0\n", kModes, "postures.csv:4: posture: 3 has no modes"},
      modes("A2", "B2", "modes.csv:2: posture: \"B2\" is not in postures.csv"),
      modes("1,2,500", "1,1,500", "modes.csv:4: mode: mode 1 of posture 1 stands twice"),
      modes("12.5", "0", "modes.csv:2: frequency_hz: 0 is out of range"),
      modes("12.5", "-3", "modes.csv:2: frequency_hz: -3 is out of range"),
      modes("12.5", "nan", "modes.csv:2: frequency_hz: \"nan\" is no number"),
      modes("0.03", "0", "modes.csv:2: damping_ratio: 0 is out of range; give a number between 0 and 1"),
      modes("0.03", "1", "modes.csv:2: damping_ratio: 1 is out of range"),
      modes("1e6", "0", "modes.csv:2: stiffness_n_per_m: 0 is out of range"),
      modes("1,0,0", "0,0,0", "modes.csv:2: ux: the direction's length is 0; ux, uy, uz is a unit vector"),
      modes("1,0,0", "1,1,0", "modes.csv:2: ux: the direction's length is 1.41421"),
      modes("uz", "height", "modes.csv:1: uz: the header lacks this column"),
      modes("damping_ratio", "damping_rato", "modes.csv:1: damping_rato: unknown column; did you mean damping_ratio?"),
  };
  for (const Mistake& mistake : mistakes) {
    const std::string message = error_of(mistake.postures, mistake.modes);
    EXPECT_TRUE(message.starts_with(mistake.message)) << message << "\nexpected: " << mistake.message;
  }
}

TEST(DynamicsMapFile, RefusesPartOfTheJointColumns) {
  EXPECT_EQ(error_of("posture,j1_deg,x_mm,y_mm,z_mm\n1,0,0,0,0\n", kModes),
            "postures.csv:1: j2_deg: the header lacks this column; add it");
}

TEST(DynamicsMapFile, NamesAMissingFile) {
  const TempFolder folder;
  EXPECT_EQ(message_of<InputError>([&] { read_dynamics_map(folder.path()); }),
            (folder.path() / "postures.csv").string() + ": no such file; check the path");
}

TEST(DynamicsMapFile, RefusesAFolderThatCannotBeMade) {
  const TempFolder folder;
  const auto file = folder.write("plain", "a file");
  EXPECT_THROW(write_dynamics_map(file / "map", {}), InputError);
}

DynamicsMap random_map(std::mt19937& random, bool has_joints) {
  std::uniform_real_distribution<double> angle(-pi, pi), place(-3, 3), frequency(5, 1000), ratio(0.001, 0.2);
  std::normal_distribution<double> component;
  DynamicsMap map;
  map.has_joints = has_joints;
  for (int p = 0; p < 5; ++p) {
    Posture posture;
    posture.id = "area, \"" + std::to_string(p) + "\"";
    if (has_joints) {
      for (double& joint : posture.joints) joint = angle(random);
    }
    for (double& coordinate : posture.position) coordinate = place(random);
    for (int m = 0; m < 4; ++m) {
      const double x = component(random), y = component(random), z = component(random), length = std::hypot(x, y, z);
      posture.modes.push_back(
          {frequency(random), ratio(random), 1e7 * ratio(random), {x / length, y / length, z / length}});
    }
    std::sort(posture.modes.begin(), posture.modes.end(),
              [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; });
    map.postures.push_back(posture);
  }
  return map;
}

// Equal bits where no unit is converted; two roundings where one is.
TEST(DynamicsMapFile, ReadsBackWhatItWrote) {
  std::mt19937 random(3);
  for (const bool has_joints : {true, false}) {
    const TempFolder folder;
    const DynamicsMap map = random_map(random, has_joints);
    write_dynamics_map(folder.path() / "new" / "map", map);
    const DynamicsMap back = read_dynamics_map(folder.path() / "new" / "map");
    EXPECT_EQ(back.has_joints, has_joints);
    ASSERT_EQ(back.postures.size(), map.postures.size());
    for (std::size_t p = 0; p < map.postures.size(); ++p) {
      const Posture &a = map.postures[p], &b = back.postures[p];
      EXPECT_EQ(a.id, b.id);
      for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(a.joints[i], b.joints[i], 4e-16 * std::abs(a.joints[i]));
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a.position[i], b.position[i], 4e-16 * std::abs(a.position[i]));
      ASSERT_EQ(a.modes.size(), b.modes.size());
      for (std::size_t m = 0; m < a.modes.size(); ++m) {
        EXPECT_NEAR(a.modes[m].natural_frequency, b.modes[m].natural_frequency, 4e-16 * a.modes[m].natural_frequency);
        EXPECT_EQ(a.modes[m].damping_ratio, b.modes[m].damping_ratio);
        EXPECT_EQ(a.modes[m].stiffness, b.modes[m].stiffness);
        EXPECT_EQ(a.modes[m].direction, b.modes[m].direction);
      }
    }
  }
}

TEST(DynamicsMapFile, TakesNumbersOfModesThatAreNotInARow) {
  std::mt19937 random(4);
  const DynamicsMap map = random_map(random, false);
  const auto [postures, modes] = dynamics_map_text(map, {.mode_numbers = {5, {2, 1, 7, 4}}});
  const DynamicsMap back = read(postures, modes);
  EXPECT_EQ(back.postures[4].modes[2].stiffness, map.postures[4].modes[2].stiffness);
  EXPECT_EQ(modes.substr(0, modes.find('\n', 80)).find("\"area, \"\"0\"\"\",2,"), modes.find('\n') + 1);
}

TEST(DynamicsMapFile, PlacesThatNobodyKnowsStayEmptyAndAreAskedForInReading) {
  std::mt19937 random(4);
  const auto [postures, modes] = dynamics_map_text(random_map(random, false), {.places_known = false});
  EXPECT_EQ(postures.substr(0, postures.find('\n', 25)), "posture,x_mm,y_mm,z_mm\n\"area, \"\"0\"\"\",,,");
  EXPECT_EQ(error_of(postures, modes).substr(0, 22), "postures.csv:2: x_mm: ");
}

TEST(DynamicsMapFile, ReadsPosturesAlone) {
  const TempFolder folder;
  const DynamicsMap map = read_postures(folder.write("places.csv", kHexapodPostures));
  ASSERT_EQ(map.postures.size(), 2U);
  EXPECT_TRUE(map.postures[1].modes.empty());
  EXPECT_NEAR(map.postures[1].position[0], 0.1, 1e-15);
  EXPECT_THROW((void)read_postures(folder.write("none.csv", "posture,x_mm,y_mm,z_mm\n")), InputError);
}

}  // namespace
}  // namespace stillcut
