#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "tools/programs.hpp"

namespace stillcut {
namespace {

struct PassesOutput {
  int code = 0;
  std::string out, err;
};

PassesOutput passes_command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"stillcut", "passes"});
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  PassesOutput output;
  output.code = run_stillcut(static_cast<int>(argv.size()), argv.data());
  output.out = testing::internal::GetCapturedStdout();
  output.err = testing::internal::GetCapturedStderr();
  return output;
}

TEST(PassesCommand, SetsThePaperBesideOurs) {
  const auto folder = std::filesystem::path(::testing::TempDir());
  const auto csv = folder / "stillcut_passes.csv", wall = folder / "stillcut_wall.svg";
  const PassesOutput ran = passes_command(
      {"--json", "--cutting-time", "0.5", "--discs", "2", "--csv", csv.string(), "--plot-wall", wall.string()});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  ASSERT_EQ(json["passes"].size(), 4u);
  EXPECT_NEAR(json["step_s"].get<double>(), 3.2086e-5, 1e-9);
  std::map<std::string, nlohmann::json> of_first;
  for (const auto& quantity : json["passes"][0]["quantities"]) of_first[quantity["quantity"]] = quantity;
  EXPECT_EQ(json["passes"][0]["pass"], "longitudinal down");
  EXPECT_EQ(of_first["wall Ra"]["paper"], 0.32);
  EXPECT_GT(of_first["wall Ra"]["ours"], 0.1);
  EXPECT_EQ(of_first["spectrum, peak at the tooth passing frequency"]["paper"], 623.33);
  EXPECT_NEAR(of_first["spectrum, peak at the tooth passing frequency"]["ours"].get<double>(), 623.33, 0.01);
  EXPECT_TRUE(of_first["feed force, rms"]["paper"].is_null());
  for (const auto& quantity : json["passes"][1]["quantities"]) {
    if (quantity["quantity"] == "wall Ra") {
      EXPECT_TRUE(quantity["paper"].is_null());
    }
  }
  const CsvTable table = read_csv(csv);
  EXPECT_EQ(table.header(), (std::vector<std::string>{"pass", "quantity", "unit", "paper", "ours"}));
  EXPECT_EQ(table.rows().size(), 4 * json["passes"][0]["quantities"].size());
  EXPECT_GT(std::filesystem::file_size(wall), 1000u);
  std::filesystem::remove(csv);
  std::filesystem::remove(wall);
}

TEST(PassesCommand, SaysWhatItCannotDo) {
  const PassesOutput far = passes_command({"--place", "3000,0,0"});
  EXPECT_EQ(far.code, 2);
  EXPECT_NE(far.err.find("does not reach"), std::string::npos) << far.err;
  EXPECT_EQ(passes_command({"--steps", "10"}).code, 2);
  EXPECT_EQ(passes_command({"--plot-wall", "wall.pdf"}).code, 3);
  EXPECT_EQ(passes_command({"--json", "--csv", "-"}).code, 2);
}

}  // namespace
}  // namespace stillcut
