#include "drivers/files/feed_map_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "drivers/files/input_error.hpp"
#include "models/machining.hpp"
#include "tests/drivers/files/example_cell.hpp"

namespace stillcut {
namespace {

std::filesystem::path map_file(const TempFolder& folder, const std::string& text) {
  const std::filesystem::path file = folder.path() / "feed.csv";
  std::ofstream{file} << text;
  return file;
}

TEST(FeedMapFile, ProposesTheNearestPlacesDirectionWithinReach) {
  const TempFolder folder;
  const FeedMap map = read_feed_map(map_file(folder,
                                             "x_mm,y_mm,feed_direction_deg,spindle_speed_rpm,a_lim_mm\n"
                                             "0,0,45,3400,0.3\n50,0,50,3400,0.3\n0,100,135,3300,0.2\n"));
  EXPECT_NEAR(map.reach, 0.1, 1e-12);
  EXPECT_NEAR(rad_to_deg(planned_direction(map, 0.02, 0.0)), 45.0, 1e-9);
  EXPECT_NEAR(rad_to_deg(planned_direction(map, 0.03, 0.0)), 50.0, 1e-9);
  EXPECT_NEAR(rad_to_deg(planned_direction(map, 0.0, 0.19)), 135.0, 1e-9);
  EXPECT_TRUE(std::isnan(planned_direction(map, 0.0, 0.21)));
  EXPECT_TRUE(std::isnan(planned_direction(FeedMap{}, 0.0, 0.0)));
}

TEST(FeedMapFile, ASingleRowHoldsEverywhere) {
  const TempFolder folder;
  const FeedMap map = read_feed_map(map_file(folder, "x_mm,y_mm,feed_direction_deg\n0,0,45\n"));
  EXPECT_NEAR(rad_to_deg(planned_direction(map, 3.0, 1.0)), 45.0, 1e-9);
}

TEST(FeedMapFile, NamesFileAndLineOfWhatIsWrong) {
  const std::string head = "x_mm,y_mm,feed_direction_deg\n";
  const std::pair<std::string, std::string> cases[] = {
      {head, "has no row"},
      {head + "0,0,45\n0,0,50\n", "feed.csv:3"},
      {head + "0,0,400\n", "400 is out of range"},
      {head + "0,nan,40\n", "feed.csv:2"},
      {"x_mm,y_mm\n0,0\n", "feed_direction_deg"},
  };
  for (const auto& [text, message] : cases) {
    const TempFolder folder;
    try {
      read_feed_map(map_file(folder, text));
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
    }
  }
}

}  // namespace
}  // namespace stillcut
