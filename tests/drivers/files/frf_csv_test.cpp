// Frequency responses as CSV.
#include "drivers/files/frf_csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/frf_cases.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

TEST(FrfCsv, ComesBackToTheLastBit) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 300; ++n) {
    const FrequencyResponse response = random_response(random);
    std::ostringstream out;
    write_frf_csv(out, response);
    const FrequencyResponse back = parse_frf_csv(out.str(), "a.csv");
    ASSERT_EQ(back.frequencies_hz, response.frequencies_hz);
    ASSERT_EQ(back.receptance, response.receptance) << out.str();
    ASSERT_EQ(back.coherence, response.coherence) << out.str();
    ASSERT_EQ(back.added_decay_per_s, response.added_decay_per_s);
    ASSERT_EQ(back.force_error, response.force_error);
  }
}

// Fails where response and force change places, or real and imaginary part.
TEST(FrfCsv, IsReadAsItsColumnsSay) {
  const FrequencyResponse r = parse_frf_csv(
      "h_xy_im,note,frequency_hz,h_xy_re,h_zz_re,h_zz_im\n-2e-7,a,10,1e-7,3,4\n0,b,11.5,5,6,7\n", "a.csv");
  EXPECT_EQ(r.frequencies_hz, (std::vector<double>{10.0, 11.5}));
  EXPECT_EQ(measured_entries(r), 2U);
  EXPECT_EQ(r.receptance[0][1], (ComplexValues{{1e-7, -2e-7}, {5, 0}}));
  EXPECT_EQ(r.receptance[2][2], (ComplexValues{{3, 4}, {6, 7}}));
}

TEST(FrfCsv, NamesFileAndLineOfWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"h_xx_re,h_xx_im\n1,2\n", "a.csv:1: frequency_hz: the header lacks"},
      {"frequency_hz\n1\n", "a.csv:1: has no pair such as"},
      {"frequency_hz,h_xx_re\n1,2\n", "a.csv:1: h_xx_im: the header lacks this column, the other of its pair"},
      {"frequency_hz,h_xx_im\n1,2\n", "a.csv:1: h_xx_re: the header lacks"},
      {"frequency_hz,h_xx_re,h_xx_im\n", "a.csv:1: has no row"},
      {"frequency_hz,h_xx_re,h_xx_im\n1,2,3\n1,2,3\n", "a.csv:3: frequency_hz: \"1\" is not above"},
      {"frequency_hz,h_xx_re,h_xx_im\n-1,2,3\n", "a.csv:2: frequency_hz: \"-1\" is below 0"},
      {"frequency_hz,h_xx_re,h_xx_im\n1,,3\n", "a.csv:2: h_xx_re: \"\" is no number"},
      {"frequency_hz,h_xx_re,h_xx_im\n1,2,nan\n", "a.csv:2: h_xx_im: \"nan\" is no number"},
      {"frequency_hz,h_xx_re,h_xx_im,coherence_xx\n1,2,3,1.2\n", "a.csv:2: coherence_xx: \"1.2\" is no coherence"},
      {"frequency_hz,h_xx_re,h_xx_im,added_decay_per_s\n1,2,3,4\n2,3,4,5\n",
       "a.csv:3: added_decay_per_s: \"5\" must be from 0 up and the same in every row"},
      {"frequency_hz,h_xx_re,h_xx_im,added_decay_per_s\n1,2,3,-4\n", "a.csv:2: added_decay_per_s: \"-4\""},
      {"frequency_hz,h_xx_re,h_xx_im\n1,2\n", "a.csv:2: has 2 fields"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(message_of<InputError>([&] { (void)parse_frf_csv(text, "a.csv"); }), testing::HasSubstr(message))
        << text;
}

}  // namespace
}  // namespace stillcut
