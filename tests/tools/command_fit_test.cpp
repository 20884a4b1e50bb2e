// stillcut fit, as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/tools/frf_folder.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;

TEST(FitCommand, FindsTheModesAndNumbersThemAlikeAtEveryPosture) {
  const FrfRow row;
  const Finished done = row.fit_all();
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const DynamicsMap map = read_dynamics_map(row.path() / "map");
  ASSERT_EQ(map.postures.size(), 5U);
  const CsvTable modes = read_csv(row.path() / "map" / "modes.csv");
  EXPECT_EQ(modes.header(), (std::vector<std::string>{"posture", "mode", "frequency_hz", "damping_ratio",
                                                      "stiffness_n_per_m", "ux", "uy", "uz"}));
  ASSERT_EQ(modes.rows().size(), 15U);
  for (const CsvRow& mode : modes.rows()) {
    const auto number = [&](const char* name) { return modes.number(mode, modes.require_column(name)); };
    const double at = FrfRow::place(static_cast<std::size_t>(number("posture")) - 1);
    // Mean frequencies: 35 Hz and 35.5 Hz, then 140 Hz.
    const Mode truth = crossing_modes(at)[static_cast<std::size_t>(number("mode")) - 1];
    EXPECT_NEAR(number("frequency_hz") * kTwoPi / truth.natural_frequency, 1.0, 2e-3);
    EXPECT_NEAR(number("damping_ratio") / truth.damping_ratio, 1.0, 0.05);
    EXPECT_NEAR(number("stiffness_n_per_m") / truth.stiffness, 1.0, 0.08);
    const double cosine =
        number("ux") * truth.direction[0] + number("uy") * truth.direction[1] + number("uz") * truth.direction[2];
    EXPECT_GT(std::abs(cosine), std::cos(0.06));
  }
}

TEST(FitCommand, UncertaintyHasARowForEachModeAndCoversTheTruth) {
  const FrfRow row;
  ASSERT_EQ(row.fit_all().exit_code, 0);
  const CsvTable modes = read_csv(row.path() / "map" / "modes.csv"),
                 sure = read_csv(row.path() / "map" / "uncertainty.csv");
  EXPECT_EQ(sure.header(), (std::vector<std::string>{"posture", "mode", "frequency_hz_se", "damping_ratio_se",
                                                     "stiffness_n_per_m_se", "direction_deg_se"}));
  ASSERT_EQ(sure.rows().size(), modes.rows().size());
  for (std::size_t i = 0; i < sure.rows().size(); ++i) {
    const auto of = [&](const CsvTable& table, const char* name) {
      return table.number(table.rows()[i], table.require_column(name));
    };
    EXPECT_EQ(of(sure, "posture"), of(modes, "posture"));
    EXPECT_EQ(of(sure, "mode"), of(modes, "mode"));
    const Mode truth = crossing_modes(FrfRow::place(static_cast<std::size_t>(of(modes, "posture")) -
                                                    1))[static_cast<std::size_t>(of(modes, "mode")) - 1];
    const double off = std::abs(of(modes, "frequency_hz") - truth.natural_frequency / kTwoPi);
    EXPECT_LT(off, 5.0 * of(sure, "frequency_hz_se"));
    EXPECT_LT(of(sure, "frequency_hz_se"), 0.5);
    for (const char* name : {"frequency_hz_se", "damping_ratio_se", "stiffness_n_per_m_se", "direction_deg_se"})
      EXPECT_GT(of(sure, name), 0.0) << name;
  }
}

TEST(FitCommand, TellsTracksLeavingOutDoubtsAndTheNextTap) {
  const FrfRow row;
  const Finished done = row.fit_all();
  for (const char* words :
       {"posture 3 (3.csv): fit off by", " +- ", "reciprocity by", "modes over the postures:", "at 5 of 5 postures",
        "Each posture predicted from all the others", "A next tap test would help most at ", " mm: "})
    EXPECT_THAT(done.out, HasSubstr(words));
}

TEST(FitCommand, JsonHasEveryFigureWithItsDeviation) {
  const FrfRow row;
  const Finished done = row.fit_all({"--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  ASSERT_EQ(json["postures"].size(), 5U);
  const DynamicsMap map = read_dynamics_map(row.path() / "map");
  for (std::size_t p = 0; p < 5; ++p) {
    const auto& modes = json["postures"][p]["modes"];
    ASSERT_EQ(modes.size(), map.postures[p].modes.size());
    for (std::size_t m = 0; m < modes.size(); ++m) {
      EXPECT_NEAR(modes[m]["frequency_hz"].get<double>() * kTwoPi, map.postures[p].modes[m].natural_frequency, 1e-9);
      for (const char* name : {"frequency_hz", "frequency_hz_se", "damping_ratio", "damping_ratio_se",
                               "stiffness_n_per_m", "stiffness_n_per_m_se", "ux", "uy", "uz", "direction_deg_se"})
        EXPECT_TRUE(modes[m][name].is_number()) << name;
    }
  }
  EXPECT_EQ(json["tracks"].size(), 3U);
  EXPECT_EQ(json["tracks"][2]["found"], 5);
  EXPECT_EQ(json["leave_one_out"]["postures"].size(), 5U);
  EXPECT_EQ(json["next_tap"]["position_mm"].size(), 3U);
}

TEST(FitCommand, GivesTheSameMapOnOneThreadAndOnFour) {
  const FrfRow row;
  ASSERT_EQ(row.fit_all({"--jobs", "1"}).exit_code, 0);
  const std::string modes = content_of(row.path() / "map" / "modes.csv");
  ASSERT_EQ(row.fit_all({"--jobs", "4"}).exit_code, 0);
  EXPECT_EQ(content_of(row.path() / "map" / "modes.csv"), modes);
}

TEST(FitCommand, ASinglePostureNeedsNoPlaceAndCsvAndUniversalFileAgree) {
  const FrfFolder folder;
  const FrfAsked x_only{.forces = {0}};
  folder.write_csv("home.csv", crossing_modes(0.2), x_only);
  folder.write_uff_file("home.uff", crossing_modes(0.2), x_only);
  const Finished csv = folder.fit({"home.csv", "--out", "a"}), uff = folder.fit({"home.uff", "--out", "b"});
  ASSERT_EQ(csv.exit_code, 0) << csv.err;
  ASSERT_EQ(uff.exit_code, 0) << uff.err;
  EXPECT_THAT(csv.out, HasSubstr("it stands at 0, 0, 0"));
  EXPECT_THAT(csv.out, HasSubstr("a single posture"));
  const DynamicsMap a = read_dynamics_map(folder.path() / "a"), b = read_dynamics_map(folder.path() / "b");
  EXPECT_EQ(a.postures[0].id, "home");
  ASSERT_EQ(a.postures[0].modes.size(), b.postures[0].modes.size());
  for (std::size_t m = 0; m < a.postures[0].modes.size(); ++m)
    EXPECT_NEAR(a.postures[0].modes[m].natural_frequency / b.postures[0].modes[m].natural_frequency, 1.0, 1e-6);
}

TEST(FitCommand, CrossResponsesOfExactlyNothingDoNotOutweighTheOthers) {
  const FrfFolder folder;
  const std::vector<Mode> modes{{kTwoPi * 31.0, 0.03, 2e6, {1, 0, 0}},
                                {kTwoPi * 39.0, 0.03, 3e6, {0, 1, 0}},
                                {kTwoPi * 90.0, 0.03, 9e6, {0, 0, 1}}};
  FrequencyResponse response = response_of(modes, {});
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (i != j) response.receptance[i][j].assign(response.frequencies_hz.size(), 0.0);
  std::ostringstream text;
  write_frf_csv(text, response);
  (void)folder.write("1.csv", text.str());
  const Finished done = folder.fit({"1.csv", "--out", "map"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const DynamicsMap map = read_dynamics_map(folder.path() / "map");
  ASSERT_EQ(map.postures[0].modes.size(), 3U);
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_NEAR(map.postures[0].modes[m].natural_frequency / modes[m].natural_frequency, 1.0, 1e-3);
    EXPECT_NEAR(map.postures[0].modes[m].direction[m], 1.0, 1e-3);
  }
}

TEST(FitCommand, SeveralPosturesWithoutPlacesAreFittedAndTheirPlacesAskedFor) {
  const FrfRow row;
  const Finished done = row.fit({"1.csv", "2.csv", "3.csv", "--out", "map"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("postures.csv has no places"));
  EXPECT_EQ(content_of(row.path() / "map" / "postures.csv"), "posture,x_mm,y_mm,z_mm\n1,,,\n2,,,\n3,,,\n");
  EXPECT_THAT(message_of<InputError>([&] { read_dynamics_map(row.path() / "map"); }),
              HasSubstr("postures.csv:2: x_mm"));
}

TEST(FitCommand, TakesTheOperatorsPolesForAllOrForOnePosture) {
  const FrfRow row;
  const Finished done = row.fit(
      {"1.csv", "2.csv", "--out", "map", "--postures", "postures.csv", "--poles", "30,140", "--poles", "2=140"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("without a file of responses, 3 in all, left out"));
  const DynamicsMap map = read_dynamics_map(row.path() / "map");
  ASSERT_EQ(map.postures.size(), 2U);
  ASSERT_EQ(map.postures[0].modes.size(), 2U);
  EXPECT_NEAR(map.postures[0].modes[0].natural_frequency / kTwoPi, 30.0, 1.0);
  ASSERT_EQ(map.postures[1].modes.size(), 1U);
  EXPECT_NEAR(map.postures[1].modes[0].natural_frequency / kTwoPi, 140.0, 1.0);
}

TEST(FitCommand, NeverTakesPosturesOutOfTheFileItWasGiven) {
  const FrfRow row;
  (void)row.write("map/postures.csv", content_of(row.path() / "postures.csv"));
  const Finished some = row.fit({"1.csv", "2.csv", "--out", "map", "--postures", "map/postures.csv"});
  EXPECT_EQ(some.exit_code, 3);
  EXPECT_EQ(some.err,
            "stillcut: map/postures.csv: would lose posture 3, which no file of responses is of; write the map to "
            "another folder\n");
  EXPECT_EQ(content_of(row.path() / "map" / "postures.csv"), content_of(row.path() / "postures.csv"));
  std::vector<std::string> all = kFrfFiles;
  for (const char* word : {"--out", "map", "--postures", "map/postures.csv"}) all.emplace_back(word);
  EXPECT_EQ(row.fit(all).exit_code, 0);
}

TEST(FitCommand, FitsWithinTheBandOnlyAndByEitherMethod) {
  const FrfRow row;
  for (const char* method : {"lscf", "polynomials"}) {
    const Finished done = row.fit({"1.csv", "--out", "map", "--band", "80:200", "--method", method, "--order", "12"});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const DynamicsMap map = read_dynamics_map(row.path() / "map");
    ASSERT_EQ(map.postures[0].modes.size(), 1U) << method;
    EXPECT_NEAR(map.postures[0].modes[0].natural_frequency / kTwoPi, 140.0, 0.5) << method;
  }
}

TEST(FitCommand, DrawsTheSamePicturesEveryTime) {
  const FrfRow row;
  for (const char* folder : {"a", "b"})
    ASSERT_EQ(row.fit({"1.csv", "5.csv", "--out", "map", "--postures", "postures.csv", "--plots", folder}).exit_code,
              0);
  for (const char* name : {"frf-1.png", "frf-5.png", "mac.svg", "frequencies.svg"}) {
    EXPECT_GT(content_of(row.path() / "a" / name).size(), 4000U) << name;
    EXPECT_EQ(content_of(row.path() / "a" / name), content_of(row.path() / "b" / name)) << name;
  }
}

TEST(FitCommand, ASofterToolThanAnyIsDoubted) {
  const FrfFolder folder;
  std::vector<Mode> modes = crossing_modes(0.0);
  for (Mode& mode : modes) mode.stiffness *= 1e-3;  // mm/N taken for m/N
  folder.write_csv("1.csv", modes);
  const Finished done = folder.fit({"1.csv", "--out", "map"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("are the responses in m/N?"));
}

TEST(FitCommand, HelpHasAnExample) {
  const FrfFolder folder;
  const Finished done = folder.fit({"--help"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.out, HasSubstr("Example"));
}

}  // namespace
}  // namespace stillcut
