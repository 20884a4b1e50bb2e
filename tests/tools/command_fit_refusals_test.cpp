// stillcut fit on what cannot be a map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/tools/frf_folder.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct FitRefusal {
  std::vector<std::string> arguments;
  int exit_code;
  std::string names;
};

TEST(FitCommand, RefusesInOneLineAndLeavesTheMapThatIsThere) {
  const FrfRow row;
  (void)row.write("map/modes.csv", "what was there\n");
  const std::string content = content_of(row.path() / "1.csv");
  (void)row.write("cut.csv", content.substr(0, content.size() / 2));
  (void)row.write("gap.csv", "frequency_hz,h_xx_re,h_xx_im\n1,1e-6,0\n2,,0\n3,1e-6,0\n");
  (void)row.write("nan.csv", "frequency_hz,h_xx_re,h_xx_im\n1,1e-6,0\n2,nan,0\n3,1e-6,0\n");
  (void)row.write("few.csv", "frequency_hz,h_xx_re,h_xx_im\n1,1e-6,0\n2,1e-6,0\n3,1e-6,0\n");
  (void)row.write("text.txt", "no file of responses");
  (void)row.write("x/1.csv", content);
  std::ostringstream swapped;
  UffFile uff = uff_of(response_of(crossing_modes(0.0), {.lines = 50}));
  for (UffFunction& function : uff.functions) std::swap(function.ordinate, function.denominator);
  write_uff(swapped, uff, UffForm::text);
  (void)row.write("swapped.uff", swapped.str());
  const FitRefusal refusals[] = {
      {{"none.csv", "--out", "map"}, 3, "none.csv: no such file"},
      {{"1.csv", "cut.csv", "--out", "map"}, 3, "cut.csv:"},
      {{"gap.csv", "--out", "map"}, 3, "gap.csv:3: h_xx_re"},
      {{"nan.csv", "--out", "map"}, 3, "nan.csv:3: h_xx_re"},
      {{"few.csv", "--out", "map"}, 3, "few.csv: "},
      {{"swapped.uff", "--out", "map"}, 3, "swapped; export response over force"},
      {{"text.txt", "--out", "map"}, 3, "text.txt: a file of frequency responses must end in"},
      {{"1.csv", "x/1.csv", "--out", "map"}, 3, "x/1.csv: is of posture 1 as 1.csv is"},
      {{"1.csv", "cut.csv", "--out", "map", "--postures", "postures.csv"}, 3, "postures.csv: has no posture cut"},
      {{"1.csv", "--out", "map", "--postures", "no.csv"}, 3, "no.csv: no such file"},
      {{"1.csv", "--out", "map", "--poles", "9=30"}, 3, "--poles: no file is of posture 9"},
      {{"1.csv", "--out", "map", "--poles", "3000"}, 3, "1.csv: "},
      {{"1.csv", "--out", "postures.csv/x"}, 3, "postures.csv/x: cannot be made"},
      {{"1.csv"}, 2, "--out"},
      {{"--out", "map"}, 2, "FRF"},
      {{"1.csv", "--out", "map", "--poles", "30,fast"}, 2, "\"fast\" is no frequency in Hz"},
      {{"1.csv", "--out", "map", "--poles", "30", "--poles", "31"}, 2, "given twice"},
      {{"1.csv", "--out", "map", "--poles", "30,60,30"}, 2, "a frequency stands twice"},
      {{"1.csv", "--out", "map", "--band", "80"}, 2, "must be MIN:MAX in Hz"},
      {{"1.csv", "--out", "map", "--band", "80:20"}, 2, "must be MIN:MAX in Hz"},
      {{"1.csv", "--out", "map", "--method", "best"}, 2, "best"},
      {{"1.csv", "--out", "map", "--order", "0"}, 2, "--order"}};
  for (const FitRefusal& refusal : refusals) {
    const Finished done = row.fit(refusal.arguments);
    EXPECT_EQ(done.exit_code, refusal.exit_code) << done.err;
    EXPECT_THAT(done.err, StartsWith("stillcut: "));
    EXPECT_THAT(done.err, HasSubstr(refusal.names));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_EQ(done.out, "");
  }
  EXPECT_EQ(content_of(row.path() / "map" / "modes.csv"), "what was there\n");
}

}  // namespace
}  // namespace stillcut
