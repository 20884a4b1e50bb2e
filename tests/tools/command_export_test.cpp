// `stillcut export`: what each format holds, read back, are the samples that the frames of the log held; and what
// cannot be exported is refused in one line, leaving no file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sndfile.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/decoder.hpp"
#include "drivers/files/csv.hpp"
#include "drivers/files/uff58_file.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kRate_hz = 25600.0;
const std::vector<std::string> kExport{"stillcut", "export", "cell.toml", "--can", "cut.log"};

std::vector<std::string> exporting(std::initializer_list<std::string> more) {
  std::vector<std::string> arguments = kExport;
  arguments.insert(arguments.end(), more);
  return arguments;
}

// The samples of a log in their places, NaN where its sensor's frames are missing, decoded here.
std::vector<std::array<float, kMaxAxes>> samples_of(const DemoCell& files, const std::string& log) {
  const Cell cell = read_cell(files.path() / "cell.toml", {.bus = false});
  Decoder decoder{read_dbc(cell.can->dbc), *cell.can, "cell.toml"};
  std::vector<std::array<float, kMaxAxes>> samples;
  CandumpReader reader{files.path() / log};
  Decoded decoded;
  for (CanFrame frame; reader.next(frame);) {
    if (!decoder.decode(frame, decoded) || decoded.blocks == 0) continue;
    const SampleBlock& block = decoded.block[0];
    const auto nan = std::numeric_limits<float>::quiet_NaN();
    samples.insert(samples.end(), std::size_t{block.frames_lost} * block.samples, {nan, nan, nan});
    for (std::size_t i = 0; i < block.samples; ++i)
      samples.push_back({block.acceleration[0][i], block.acceleration[1][i], block.acceleration[2][i]});
  }
  return samples;
}

// A cut of which three stretches of frames are lost.
class CutWithGaps : public DemoCell {
 public:
  CutWithGaps() {
    simulate("0.3", "0:0,0.1:3");
    std::istringstream lines{content_of(path() / "cut.log")};
    std::string kept, line;
    for (int i = 0; std::getline(lines, line); ++i) {
      const bool lost = (i >= 100 && i < 103) || i == 250 || (i >= 400 && i < 440);
      if (!lost) kept.append(line).append("\n");
    }
    (void)write("cut.log", kept);
  }
};

float or_silence(float value) { return std::isnan(value) ? 0.0F : value; }

TEST(Export, CsvHoldsTheSamplesInTheirPlacesAndNothingWhereTheyAreLost) {
  const CutWithGaps files;
  const auto samples = samples_of(files, "cut.log");
  const Finished done = run(exporting({"--csv", "cut.csv", "--json"}), files.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const CsvTable table = read_csv(files.path() / "cut.csv");
  EXPECT_EQ(table.header(), (std::vector<std::string>{"time_s", "sensor", "x_m_per_s2", "y_m_per_s2", "z_m_per_s2",
                                                      "spindle_speed_rpm"}));
  ASSERT_EQ(table.rows().size(), samples.size());
  std::int64_t missing = 0;
  const double first_s = table.number(table.rows().front(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const CsvRow& row = table.rows()[i];
    ASSERT_NEAR(table.number(row, 0), first_s + static_cast<double>(i) / kRate_hz, 0.1e-3);
    ASSERT_EQ(row.fields[1], "1");
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if (std::isnan(samples[i][a]))
        ASSERT_EQ(row.fields[2 + a], "") << "row " << i;
      else
        ASSERT_EQ(std::stof(row.fields[2 + a]), samples[i][a]) << "row " << i;
    }
    ASSERT_EQ(table.number(row, 5), 8500.0);
    missing += std::isnan(samples[i][0]) ? 1 : 0;
  }
  const nlohmann::json told = nlohmann::json::parse(done.out);
  EXPECT_GT(missing, 100);
  EXPECT_EQ(told["samples_missing"], missing);
  EXPECT_EQ(told["samples"], std::ssize(samples) - missing);
}

TEST(Export, WavTimesItsFullScaleIsTheSamplesWithSilenceInTheGaps) {
  const CutWithGaps files;
  const auto samples = samples_of(files, "cut.log");
  for (const bool named : {false, true}) {
    auto arguments = exporting({"--wav", "cut.wav", "--json"});
    if (named) arguments.insert(arguments.end(), {"--wav-peak", "2000"});
    const Finished done = run(arguments, files.path());
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const float full_scale = nlohmann::json::parse(done.out)["wav_full_scale_m_per_s2"].get<float>();
    SF_INFO info{};
    const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> sound{
        sf_open((files.path() / "cut.wav").c_str(), SFM_READ, &info), &sf_close};
    ASSERT_TRUE(sound);
    EXPECT_EQ(info.samplerate, 25600);
    ASSERT_EQ(info.channels, 3);
    ASSERT_EQ(info.frames, std::ssize(samples));
    EXPECT_THAT(sf_get_string(sound.get(), SF_STR_COMMENT), HasSubstr("full scale "));
    std::vector<float> values(3 * samples.size());
    ASSERT_EQ(sf_readf_float(sound.get(), values.data(), info.frames), info.frames);
    float loudest = 0.0F;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_FLOAT_EQ(values[3 * i + a] * full_scale, or_silence(samples[i][a]));
        loudest = std::max(loudest, std::abs(values[3 * i + a]));
      }
    }
    if (named)
      EXPECT_EQ(full_scale, 2000.0F);
    else
      EXPECT_EQ(loudest, 1.0F);
  }
}

TEST(Export, UniversalFileHoldsAnAxisAFunctionInSi) {
  const CutWithGaps files;
  const auto samples = samples_of(files, "cut.log");
  const Finished done = run(exporting({"--uff", "cut.uff", "--json"}), files.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const UffFile content = parse_uff(content_of(files.path() / "cut.uff"), "cut.uff");
  ASSERT_TRUE(content.units);
  EXPECT_EQ(content.units->length, 1.0);
  ASSERT_EQ(content.functions.size(), 3U);
  for (std::size_t a = 0; a < 3; ++a) {
    const UffFunction& function = content.functions[a];
    EXPECT_EQ(function.type, kUffTimeResponse);
    EXPECT_EQ(function.response_direction, static_cast<int>(a + 1));
    EXPECT_EQ(function.ordinate.data_type, kUffAcceleration);
    EXPECT_EQ(function.ordinate.units, "m/s^2");
    EXPECT_THAT(function.id[2], HasSubstr("missing and stand as 0"));
    ASSERT_EQ(function.values.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      ASSERT_EQ(static_cast<float>(function.values[i].real()), or_silence(samples[i][a]));
    EXPECT_NEAR(function.abscissa[1000] - function.abscissa[0], 1000.0 / kRate_hz, 1e-6 * 1000.0 / kRate_hz);
  }
}

TEST(Export, AWindowHoldsTheSameRowsAsTheWhole) {
  const CutWithGaps files;
  const Finished all = run(exporting({"--csv", "-"}), files.path());
  const Finished part = run(exporting({"--csv", "-", "--from", "0.1", "--to", "0.2"}), files.path());
  ASSERT_EQ(part.exit_code, 0) << part.err;
  std::istringstream rows{all.out};
  std::string expected, row;
  std::getline(rows, expected);
  expected += '\n';
  while (std::getline(rows, row)) {
    const double time_s = std::stod(row);
    if (time_s >= 0.1 && time_s < 0.2) expected += row + '\n';
  }
  EXPECT_EQ(part.out, expected);
}

TEST(Export, EventsAreThoseOfPlaybackInTheWindow) {
  const DemoCell files;
  files.simulate("1.5", "0:0,0.2:0,0.3:3.8");
  ASSERT_EQ(run({"stillcut", "replay", "cell.toml", "--can", "cut.log", "--events", "all.csv", "--json"}, files.path())
                .exit_code,
            0);
  const std::string all = content_of(files.path() / "all.csv");
  ASSERT_THAT(all, HasSubstr("chatter_onset"));
  EXPECT_EQ(run(exporting({"--events", "-"}), files.path()).out, all);
  const CsvTable table = read_csv(files.path() / "all.csv");
  const std::string second = std::to_string(table.number(table.rows().at(1), 0));
  const Finished later = run(exporting({"--events", "-", "--from", second}), files.path());
  EXPECT_EQ(parse_csv(later.out, "later").rows().size(), table.rows().size() - 1) << later.out;
}

TEST(Export, WhatCannotBeExportedIsRefusedInOneLineAndLeavesNoFile) {
  struct Refused {
    std::vector<std::string> more;
    int exit_code;
    std::string says;
  };
  const DemoCell files;
  files.simulate("0.1", "0:3");
  for (const Refused& refused : std::vector<Refused>{
           {{"--csv", "out", "--from", "5"}, 3, "cut.log: no such window: the recording spans 0 to 0.1 s"},
           {{"--csv", "out", "--from", "2", "--to", "1"}, 2, "--to"},
           {{}, 2, "--csv"},
           {{"--csv", "-", "--json"}, 2, "standard output"},
           {{"--wav", "-"}, 2, "name a file"},
           {{"--csv", "out", "--uff", "out"}, 2, "two outputs"},
           {{"--csv", "out", "--uff", "./no/../out"}, 2, "two outputs"},
           {{"--wav", "out", "--sensor", "2"}, 2, "1 accelerometer"},
           {{"--wav", "none/out"}, 3, "none/out: cannot be written"},
           {{"--csv", "/dev/full"}, 3, "/dev/full: cannot be written to the end; is the disk full?"},
           {{"--mcap", "/dev/full"}, 3, "/dev/full: cannot be written to the end; is the disk full?"},
           {{"--uff", "/dev/full"}, 3, "/dev/full: cannot be written to the end; is the disk full?"},
       }) {
    std::vector<std::string> arguments = kExport;
    arguments.insert(arguments.end(), refused.more.begin(), refused.more.end());
    const Finished ended = run(arguments, files.path());
    EXPECT_EQ(ended.exit_code, refused.exit_code) << ended.err;
    EXPECT_THAT(ended.err, StartsWith("stillcut: "));
    EXPECT_THAT(ended.err, HasSubstr(refused.says));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(files.path() / "out")) << refused.says;
  }
}

// Opened for writing, a recording would be gone before it is read.
TEST(Export, NoCommandWritesOverTheRecordingThatItReads) {
  const DemoCell files;
  files.simulate("0.1", "0:3");
  const std::string log = content_of(files.path() / "cut.log");
  std::filesystem::create_symlink("cut.log", files.path() / "link.csv");
  for (const auto& [command, output] : std::vector<std::pair<std::string, std::string>>{{"export", "--csv"},
                                                                                        {"export", "--wav"},
                                                                                        {"export", "--mcap"},
                                                                                        {"report", "--out"},
                                                                                        {"replay", "--events"},
                                                                                        {"replay", "--plot"}}) {
    for (const char* file : {"./cut.log", "link.csv"}) {
      const Finished ended = run({"stillcut", command, "cell.toml", "--can", "cut.log", output, file}, files.path());
      EXPECT_EQ(ended.exit_code, 3) << command << ended.out;
      EXPECT_THAT(ended.err, HasSubstr("name another file"));
      ASSERT_TRUE(content_of(files.path() / "cut.log") == log) << command << ' ' << output;
    }
  }
}

TEST(Export, AClockThatWasSetByHoursIsNotFilledWithSilence) {
  const DemoCell files;
  files.simulate("0.2", "0:3");
  std::istringstream lines{content_of(files.path() / "cut.log")};
  std::string log, line;
  for (int i = 0; std::getline(lines, line); ++i) {
    if (i > 250) {
      const auto dot = line.find('.');
      line = "(" + std::to_string(std::stoll(line.substr(1, dot - 1)) + 50'000'000) + line.substr(dot);
    }
    log.append(line).append("\n");
  }
  (void)files.write("cut.log", log);
  const Finished done = run(exporting({"--wav", "out"}), files.path());
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_THAT(done.err, HasSubstr("--from and --to"));
  EXPECT_FALSE(std::filesystem::exists(files.path() / "out"));
  EXPECT_EQ(run(exporting({"--wav", "out", "--to", "0.05"}), files.path()).exit_code, 0);
}

}  // namespace
}  // namespace stillcut
