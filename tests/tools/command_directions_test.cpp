// `stillcut directions` as a user meets it: what it writes, that it agrees with `stillcut lobes`, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

Finished directions(const DemoCell& cell, std::initializer_list<std::string> more) {
  std::vector<std::string> arguments{"stillcut", "directions", "cell.toml"};
  arguments.insert(arguments.end(), more);
  return run(arguments, cell.path());
}

TEST(DirectionsCommand, CsvIsAsPinnedAndAgreesWithTheLobes) {
  const DemoCell cell;
  const Finished done = directions(cell, {"--step", "60", "--posture", "home", "--posture", "far", "--csv", "-"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const CsvTable table = parse_csv(done.out, "stdout");
  const std::vector<std::string> header{"posture", "feed_direction_deg", "a_abs_mm", "a_pocket_mm", "pocket_rpm"};
  EXPECT_EQ(table.header(), header);
  ASSERT_EQ(table.rows().size(), 12U);
  for (const std::size_t row : {1U, 8U}) {
    const std::vector<std::string>& fields = table.rows()[row].fields;
    const Finished lobes =
        run({"stillcut", "lobes", "cell.toml", "--posture", fields[0], "--feed-direction", fields[1], "--csv", "-"},
            cell.path());
    ASSERT_EQ(lobes.exit_code, 0) << lobes.err;
    double lowest = std::numeric_limits<double>::infinity(), highest = 0.0;
    const CsvTable points = parse_csv(lobes.out, "stdout");
    for (const CsvRow& point : points.rows()) {
      lowest = std::min(lowest, std::stod(point.fields[1]));
      highest = std::max(highest, std::stod(point.fields[1]));
    }
    EXPECT_NEAR(std::stod(fields[2]), lowest, 2e-3 * lowest) << fields[0] << ", " << fields[1];
    EXPECT_NEAR(std::stod(fields[3]), highest, 2e-3 * highest) << fields[0] << ", " << fields[1];
  }
}

TEST(DirectionsCommand, EveryPostureOfTheMapIsTheDefaultAndTheBestDirectionHasTheHighestLimit) {
  const DemoCell cell;
  const Finished done = directions(cell, {"--step", "45", "--method", "zoa", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const json result = json::parse(done.out);
  EXPECT_EQ(result["method"], "zoa");
  const CsvTable postures = parse_csv(content_of(cell.path() / "map" / "postures.csv"), "postures.csv");
  ASSERT_EQ(result["postures"].size(), postures.rows().size());
  for (const json& posture : result["postures"]) {
    ASSERT_EQ(posture["directions"].size(), 8U);
    double best = 0.0, at_best = -1.0;
    for (const json& direction : posture["directions"]) {
      best = std::max(best, direction["a_abs_mm"].get<double>());
      EXPECT_LE(direction["a_abs_mm"], direction["a_pocket_mm"]);
      if (direction["feed_direction_deg"] == posture["best_direction_deg"]) at_best = direction["a_abs_mm"];
    }
    EXPECT_EQ(at_best, best);
  }
}

TEST(DirectionsCommand, GivesTheSameBytesOnAnyNumberOfThreads) {
  const DemoCell cell;
  const Finished one = directions(cell, {"--step", "90", "--jobs", "1", "--csv", "-"});
  const Finished three = directions(cell, {"--step", "90", "--jobs", "3", "--csv", "-"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(one.out, three.out);
}

TEST(DirectionsCommand, RadialDepthAndMillingChangeTheLimitsAndAlternatingIsTheLower) {
  const DemoCell cell;
  const auto limits = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> arguments{"--step", "90", "--posture", "home", "--method", "zoa", "--csv", "-"};
    arguments.insert(arguments.end(), more);
    arguments.insert(arguments.begin(), {"stillcut", "directions", "cell.toml"});
    const Finished done = run(arguments, cell.path());
    EXPECT_EQ(done.exit_code, 0) << done.err;
    std::vector<double> values;
    const CsvTable table = parse_csv(done.out, "stdout");
    for (const CsvRow& row : table.rows()) values.push_back(std::stod(row.fields[2]));
    return values;
  };
  const auto down = limits({"--milling", "down"}), up = limits({"--milling", "up"});
  const auto both = limits({"--milling", "alternating"});
  EXPECT_NE(down, up);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_LE(both[i], std::min(down[i], up[i]) + 1e-12);
  EXPECT_NE(limits({"--milling", "down", "--radial-depth", "1"}), down);
}

TEST(DirectionsCommand, DrawsAPictureAndTellsALineAPosture) {
  const DemoCell cell;
  const Finished done = directions(cell, {"--step", "30", "--method", "zoa", "--plot", "d.svg"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(content_of(cell.path() / "d.svg"), HasSubstr("<svg"));
  EXPECT_THAT(done.out, HasSubstr("home: at any speed best "));
}

TEST(DirectionsCommand, RefusesWhatCannotBe) {
  const DemoCell cell;
  const Finished step = directions(cell, {"--step", "0"});
  EXPECT_EQ(step.exit_code, 2);
  EXPECT_THAT(step.err, HasSubstr("--step"));
  const Finished radial = directions(cell, {"--radial-depth", "1000"});
  EXPECT_EQ(radial.exit_code, 2);
  EXPECT_THAT(radial.err, HasSubstr("diameter"));
  const Finished posture = directions(cell, {"--posture", "nowhere"});
  EXPECT_EQ(posture.exit_code, 3);
  EXPECT_THAT(posture.err, HasSubstr("nowhere"));
}

}  // namespace
}  // namespace stillcut
