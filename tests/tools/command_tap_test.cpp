// `stillcut tap` as a user meets it: from recordings, and guided with written answers on a recorded bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/files/csv.hpp"
#include "drivers/files/frf_file.hpp"
#include "drivers/files/tap_recording_file.hpp"
#include "models/modal_identification.hpp"
#include "tests/drivers/files/tap_cases.hpp"
#include "tests/models/tapped_structure.hpp"
#include "tests/tools/tapped_cell.hpp"

namespace stillcut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kTapRate = 5120.0;

// Without the tool's own modes: a recorder this slow filters them off, which the simulated one does not.
std::vector<Mode> structure_modes() {
  std::vector<Mode> modes = home_modes();
  modes.resize(4);
  return modes;
}

// Two sound hits; between them one whose hammer rebounds.
TapRecording three_hits(int axis, double sense = 1.0) {
  const std::vector<HammerPulse> pulses{{0.5, 600, 0.003}, {3.0, 500, 0.003}, {3.04, 90, 0.003}, {6.0, 700, 0.003}};
  return tapped(structure_modes(), static_cast<std::size_t>(axis), sense, pulses, 8.0, kTapRate);
}

std::string csv_of(const TapRecording& recording) {
  std::string text = "time_s,force_n,ax_m_per_s2,ay_m_per_s2,az_m_per_s2\n";
  for (std::size_t i = 0; i < recording.force.size(); ++i) {
    text += csv_number(static_cast<double>(i) / recording.sample_rate_hz) + "," + csv_number(recording.force[i]);
    for (const std::vector<double>& axis : recording.acceleration) text += "," + csv_number(axis[i]);
    text += "\n";
  }
  return text;
}

std::string wav_of(const TapRecording& recording, double force_scale, double acceleration_scale) {
  std::vector<float> samples;
  for (std::size_t i = 0; i < recording.force.size(); ++i) {
    samples.push_back(static_cast<float>(recording.force[i] / force_scale));
    for (const std::vector<double>& axis : recording.acceleration)
      samples.push_back(static_cast<float>(axis[i] / acceleration_scale));
  }
  return WavBytes::of(WavBytes::Form::float32, static_cast<std::uint32_t>(kTapRate), 4, samples);
}

std::string uff_text_of(const TapRecording& recording, HammerDirection hammer) {
  std::ostringstream out;
  write_uff(out, uff_of(std::vector{recording}, hammer), UffForm::binary);
  return out.str();
}

Finished stillcut_tap(const TempFolder& folder, std::initializer_list<std::string> more,
                      const std::filesystem::path& input = {}) {
  std::vector<std::string> arguments{"stillcut", "tap"};
  arguments.insert(arguments.end(), more);
  return run(arguments, folder.path(), input);
}

// Breaks with a channel, an axis, a unit or a sign that goes astray in any of the forms.
TEST(TapCommand, JoinsTheDirectionsOfAPostureFromAnyFormOfRecording) {
  const TempFolder folder;
  (void)folder.write("x.csv", csv_of(three_hits(0)));
  (void)folder.write("y.wav", wav_of(three_hits(1), 2000.0, 981.0));
  (void)folder.write("z.uff", uff_text_of(three_hits(2, -1.0), {2, -1.0}));
  for (const std::string form : {"12.uff", "12.csv"}) {
    const Finished done = stillcut_tap(folder, {"x=x.csv", "y=y.wav", "z.uff", "--channels",
                                                "force:2kN,x:981m/s^2,y:981m/s^2,z:981m/s^2", "--out", form, "--json"});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    const auto json = nlohmann::json::parse(done.out);
    ASSERT_EQ(json["directions"].size(), 3U);
    for (const auto& direction : json["directions"]) {
      EXPECT_EQ(direction["hits"].size(), 3U);
      EXPECT_EQ(direction["hits_used"], 2);
      EXPECT_THAT(direction["hits"][1]["verdict"].get<std::string>(), StartsWith("double hit"));
      EXPECT_GT(direction["coherence"]["x"]["mean"], 0.999);
      EXPECT_GT(direction["excited_to_hz"], 300.0);
    }
    EXPECT_EQ(json["directions"][2]["sense"], -1.0);
    const FrequencyResponse response = read_frf(folder.path() / form).response;
    EXPECT_EQ(measured_entries(response), 9U);
    EXPECT_NEAR(response.added_decay_per_s, std::log(100.0), 1e-12);
    EXPECT_EQ(response.coherence[1][2].size(), response.frequencies_hz.size());
    for (std::size_t force = 0; force < 3; ++force)
      EXPECT_LT(off_at_resonances(response, structure_modes(), force, {0, 1, 2, 3}), 0.01) << force;
  }
}

TEST(TapCommand, TellsEveryHitAndTheWindowAndDraws) {
  const TempFolder folder;
  (void)folder.write("a.csv", csv_of(three_hits(0)));
  const Finished done = stillcut_tap(folder, {"a.csv", "--axis", "x", "--sense", "-1", "--out", "12.uff", "--binary",
                                              "--plot", "12.svg", "--estimator", "hv", "--highest", "300"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, StartsWith("towards -x: 2 of 3 hits used, lines 1 Hz apart; the hammer excites up to "));
  EXPECT_THAT(done.out, HasSubstr("  a.csv: at 0.5"));
  EXPECT_THAT(done.out, HasSubstr(" N: double hit: let the hammer rebound freely"));
  EXPECT_THAT(done.out, HasSubstr("the exponential window adds 4.6052 1/s"));
  EXPECT_THAT(content_of(folder.path() / "12.svg"), HasSubstr("<svg"));
  const FrequencyResponse response = read_frf(folder.path() / "12.uff").response;
  EXPECT_EQ(response.frequencies_hz.back(), 300.0);
  // Struck towards minus, as the user says: all signs are turned.
  const auto truth = shifted_receptance(structure_modes(), 0, 0, 10.0, response.added_decay_per_s);
  EXPECT_LT(std::abs(response.receptance[0][0][9] + truth), 0.01 * std::abs(truth));
  const Finished bare = stillcut_tap(folder, {"a.csv", "--axis", "x", "--end-weight", "1", "--out", "b.csv"});
  ASSERT_EQ(bare.exit_code, 0) << bare.err;
  EXPECT_EQ(bare.out.find("window adds"), std::string::npos);
  EXPECT_EQ(content_of(folder.path() / "b.csv").find("added_decay"), std::string::npos);
}

TEST(TapCommand, RefusesBadRecordingsWithOneLineThatNamesThem) {
  const TempFolder folder;
  TapRecording turned = three_hits(0), still = turned, silent = turned;
  for (double& value : turned.force) value = -value;
  for (double& value : still.force) value *= 1e-3;
  silent.acceleration[1].assign(silent.force.size(), 0.0);
  (void)folder.write("turned.csv", csv_of(turned));
  (void)folder.write("still.csv", csv_of(still));
  (void)folder.write("silent.csv", csv_of(silent));
  const std::string sound = csv_of(three_hits(0));
  (void)folder.write("sound.csv", sound);
  (void)folder.write("cut.csv", sound.substr(0, sound.size() / 2));
  (void)folder.write("y.uff", uff_text_of(three_hits(1), {1, 1.0}));
  const std::string binary = uff_text_of(three_hits(1), {1, 1.0});
  (void)folder.write("cut.uff", binary.substr(0, binary.size() / 2));
  (void)folder.write("a.wav", wav_of(three_hits(0), 2000.0, 981.0));
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string line;
  };
  const std::vector<Case> cases{
      {{"turned.csv", "--axis", "x"}, 3, "turned.csv: force goes down to"},
      {{"still.csv", "--axis", "x"}, 3, "still.csv: no hit: force stays below the trigger of 20 N"},
      {{"silent.csv", "--axis", "x"}, 3, "silent.csv: acceleration y is zero throughout"},
      {{"cut.csv", "--axis", "x"}, 3, "cut.csv:"},
      {{"cut.uff"}, 3, "cut.uff:"},
      {{"sound.csv"}, 3, "sound.csv: does not tell the hammer's axis; give --axis x, or x=sound.csv"},
      {{"sound.csv", "--axis", "x", "--force-full-scale", "450"}, 3, "sound.csv: no hit can be used: at 0.5"},
      {{"x=y.uff"}, 3, "y.uff: tells of a hammer towards y, not x; leave its direction"},
      {{"a.wav", "--axis", "x"}, 3, "a.wav: a WAV file tells no units; name its channels"},
      {{"a.wav", "--axis", "x", "--channels", "force:2000N,x:9g"}, 3, "a.wav: has 4 channels, but 2 are named"},
      {{"a.wav", "--axis", "x", "--channels", "force:2000N,x:9m"}, 2, "'x:9m' has no unit of acceleration"},
      {{"absent.csv", "--axis", "x"}, 3, "absent.csv: no such file"},
      {{"sound.mat", "--axis", "x"}, 3, "sound.mat: a recording of taps must end in"},
      {{"sound.csv", "--axis", "w"}, 2, "'w' is none of x, y, z"},
      {{"sound.csv", "--axis", "x", "--out", "12.txt"}, 3, "12.txt: a file of frequency responses must end in"},
      {{"sound.csv", "--axis", "x", "--record", "0"}, 3, "sound.csv: a tap's record must be longer than 0 s"},
      {{"sound.csv", "--axis", "x", "--highest", "3000"}, 3, "sound.csv: the highest frequency must be below half"},
      {{"sound.csv", "--simulate", "a.log"}, 2, "--simulate: needs a cell file"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> arguments{"stillcut", "tap"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const Finished done = run(arguments, folder.path());
    EXPECT_EQ(done.exit_code, c.exit_code) << c.line << '\n' << done.err;
    EXPECT_THAT(done.err, HasSubstr(c.line));
    EXPECT_THAT(done.err, StartsWith("stillcut: "));
    EXPECT_EQ(std::ranges::count(done.err, '\n'), 1) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "12.txt"));
  }
}

// From simulated taps over a candump log and scripted answers to responses. Breaks with the order of the directions, a
// sample's delay between hammer and sensor, or a file that is not written.
TEST(TapCommand, GuidesThroughTheDirectionsOfEveryPosture) {
  const DemoCell cell;
  const auto answers = cell.write("answers", "a\nr\na\na\na\na\na\n");
  // Along y the first round is thrown away: it is in the log twice.
  const auto log = [&](const std::string& name, const std::string& directions, const std::string& posture) {
    const Finished done = stillcut_tap(cell, {"cell.toml", "--posture", posture, "--directions", directions, "--hits",
                                              "2", "--simulate", name, "--json"});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(nlohmann::json::parse(done.out)["hits"], 2 * (1 + std::ranges::count(directions, ',')));
  };
  log("xy.log", "x,y", "home");
  log("yz.log", "y,-z", "home");
  log("left.log", "x,y,-z", "left");
  (void)cell.write("taps.log", content_of(cell.path() / "xy.log") + content_of(cell.path() / "yz.log") +
                                   content_of(cell.path() / "left.log"));
  (void)cell.write("places.csv", "posture,x_mm,y_mm,z_mm\nhome,1100,0,600\nleft,1050,450,550\nfar,1450,0,550\n");
  const std::vector<std::string> arguments{"stillcut",  "tap",       "cell.toml",  "--bus",      "log:taps.log",
                                           "--posture", "home,left", "--postures", "places.csv", "--directions",
                                           "x,y,-z",    "--hits",    "2",          "--out",      "taps",
                                           "--plot",    "left.svg"};
  const Finished done = run(arguments, cell.path(), answers);
  ASSERT_EQ(done.exit_code, 0) << done.err << done.out;
  EXPECT_THAT(done.out, HasSubstr("posture home, hammer towards -z: hit 2 times"));
  EXPECT_THAT(done.out, HasSubstr("2 of 2 postures in taps"));
  const DynamicsMap map = read_dynamics_map(cell.path() / "map");
  for (const Posture& posture : map.postures) {
    const auto file = cell.path() / "taps" / (posture.id + ".uff");
    if (posture.id != "home" && posture.id != "left") {
      EXPECT_FALSE(std::filesystem::exists(file));
      continue;
    }
    const FrequencyResponse response = read_frf(file).response;
    EXPECT_EQ(measured_entries(response), 9U);
    EXPECT_LT(off_at_resonances(response, posture.modes, 0, kAlongXResonances), 0.01) << posture.id;
    EXPECT_LT(off_at_resonances(response, posture.modes, 1, kAlongYResonances), 0.01) << posture.id;
    const TapFile raw = read_tap_file(cell.path() / "taps" / "taps" / (posture.id + "-z.uff"));
    EXPECT_EQ(raw.taps.size(), 2U);
    EXPECT_EQ(raw.taps[0].direction, (HammerDirection{2, -1.0}));
  }
  EXPECT_EQ(content_of(cell.path() / "taps" / "postures.csv"),
            "posture,x_mm,y_mm,z_mm\nhome,1100,0,600\nleft,1050,450,550\n");
  EXPECT_THAT(content_of(cell.path() / "left.svg"), HasSubstr("<svg"));
  // What is there is not overwritten; the kept hits give the same responses again.
  const Finished again = run(arguments, cell.path(), answers);
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("home.uff: is there already; choose another --out, or --replace it"));
  ASSERT_EQ(
      stillcut_tap(cell, {"taps/taps/home-x.uff", "taps/taps/home-y.uff", "taps/taps/home-z.uff", "--out", "home.uff"})
          .exit_code,
      0);
  EXPECT_EQ(content_of(cell.path() / "home.uff"), content_of(cell.path() / "taps" / "home.uff"));
}

// All the way: what taps on the map's structure tell is the map. Breaks where the window's decay is lost on the way,
// which doubles the damping of the lowest mode.
TEST(TapCommand, LeavesWhatGivesTheMapsModesAgain) {
  const DemoCell cell;
  const auto answers = cell.write("answers", "a\na\n");
  ASSERT_EQ(stillcut_tap(cell, {"cell.toml", "--posture", "home", "--directions", "x,y", "--hits", "3", "--simulate",
                                "taps.log"})
                .exit_code,
            0);
  const Finished done = stillcut_tap(cell,
                                     {"cell.toml", "--bus", "log:taps.log", "--posture", "home", "--directions", "x,y",
                                      "--hits", "3", "--highest", "900", "--out", "taps"},
                                     answers);
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const ModalFit fit = identify_modes(read_frf(cell.path() / "taps" / "home.uff").response, {.lowest_hz = 8.0});
  const std::vector<Mode> modes = home_modes();
  ASSERT_EQ(fit.modes.size(), modes.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Mode& found = fit.modes[i].mode;
    EXPECT_NEAR(found.natural_frequency, modes[i].natural_frequency, 0.005 * modes[i].natural_frequency) << i;
    EXPECT_NEAR(found.damping_ratio, modes[i].damping_ratio, 0.05 * modes[i].damping_ratio) << i;
    EXPECT_NEAR(found.stiffness, modes[i].stiffness, 0.02 * modes[i].stiffness) << i;
  }
}

TEST(TapCommand, KeepsWhatWasAcceptedWhereTheOperatorQuitsOrTheLogEnds) {
  const DemoCell cell;
  const auto answers = cell.write("answers", "a\nq\n");
  ASSERT_EQ(stillcut_tap(cell, {"cell.toml", "--posture", "home", "--directions", "x,y", "--hits", "1", "--simulate",
                                "taps.log"})
                .exit_code,
            0);
  const Finished quit = stillcut_tap(
      cell, {"cell.toml", "--bus", "log:taps.log", "--posture", "home", "--hits", "1", "--out", "quit", "--json"},
      answers);
  ASSERT_EQ(quit.exit_code, 0) << quit.err;
  const auto json = nlohmann::json::parse(quit.out);
  EXPECT_EQ(json["postures"][0]["directions"].size(), 1U);
  EXPECT_THAT(quit.err, HasSubstr("coherence is not known from one hit"));
  EXPECT_EQ(measured_entries(read_frf(cell.path() / "quit" / "home.uff").response), 3U);
  const auto more = cell.write("more", "a\na\na\n");
  const Finished ended = stillcut_tap(
      cell, {"cell.toml", "--bus", "log:taps.log", "--posture", "home", "--hits", "1", "--out", "ended"}, more);
  EXPECT_EQ(ended.exit_code, 3);
  EXPECT_THAT(ended.err, HasSubstr("log:taps.log: ends before the hits that are asked for"));
  EXPECT_EQ(measured_entries(read_frf(cell.path() / "ended" / "home.uff").response), 6U);
}

TEST(TapCommand, RefusesACellOrAPostureThatCannotBeTapped) {
  const DemoCell cell;
  const auto refused = [&](std::initializer_list<std::string> more, int exit_code, const std::string& line) {
    const Finished done = stillcut_tap(cell, more);
    EXPECT_EQ(done.exit_code, exit_code) << line;
    EXPECT_THAT(done.err, HasSubstr(line));
  };
  refused({"cell.toml", "--posture", "home"}, 2, "--out");
  refused({"cell.toml", "--out", "a"}, 2, "--posture or --postures");
  refused({"cell.toml", "--out", "a", "--posture", "../b"}, 3, "posture '../b': is no name of a file");
  refused({"cell.toml", "--out", "a", "--posture", "b", "--directions", "x,-x"}, 2, "'-x' is there twice");
  refused({"cell.toml", "--out", "a", "--posture", "b", "--sensor", "2"}, 3, "number 2 is asked for");
  refused({"cell.toml", "a.csv"}, 2, "is one cell file, or recordings");
  refused({"cell.toml", "--posture", "nowhere", "--simulate", "a.log"}, 3, "nowhere");
  cell.change("[can.hammer]\nsample_rate_hz = 25600\nforce_n = \"Hammer.Force{0..9}\"\ncounter = \"Hammer.Counter\"\n",
              "");
  refused({"cell.toml", "--out", "a", "--posture", "b"}, 3, "cell.toml:");
  refused({"cell.toml", "--out", "a", "--posture", "b"}, 3, "can.hammer: is missing; add [can.hammer]");
}

}  // namespace
}  // namespace stillcut
