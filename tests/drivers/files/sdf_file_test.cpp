// Surface data files: what other programs wrote is read, what we wrote comes back, what is spoilt is refused.
#include "drivers/files/sdf_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/height_map_cases.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

std::string sdf_of(const HeightMap& map) {
  std::ostringstream out;
  write_sdf(out, map);
  return out.str();
}

TEST(SdfFile, ComesBackToTheLastBit) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 500; ++n) {
    const HeightMap map = random_height_map(random);
    ASSERT_TRUE(same_map(parse_sdf(sdf_of(map), "map.sdf"), map)) << sdf_of(map);
  }
}

// The header line for line: readers look for these names in this order.
TEST(SdfFile, IsWrittenAsTheStandardSays) {
  const HeightMap map{3, 2, 4e-6, 5e-6, {1e-6, kNaN, -2.5e-6, 0.0, 1.0, 2e-9}};
  EXPECT_EQ(sdf_of(map),
            "aISO-1.0\r\nManufacID = Stillcut\r\nCreateDate = 010119700000\r\nModDate = 010119700000\r\n"
            "NumPoints = 3\r\nNumProfiles = 2\r\nXscale = 4e-06\r\nYscale = 5e-06\r\nZscale = 1\r\n"
            "Zresolution = -1\r\nCompression = 0\r\nDataType = 7\r\nCheckType = 0\r\n*\r\n"
            "1e-06 BAD -2.5e-06\r\n0 1 2e-09\r\n*\r\n");
}

// Whole numbers with a scale, aligned names, a trailer, LF: MountainsMap's manner. One height a line and no closing
// star: Gwyddion's.
TEST(SdfFile, OfOtherProgramsIsRead) {
  const HeightMap mountains = parse_sdf(
      "aISO-1.0\nManufacID      = test\nCreateDate     = 230920261959\nModDate        = 240920260805\n"
      "NumPoints      = 3\nNumProfiles    = 2\nXscale         = 1e-06\nYscale         = 2e-06\n"
      "Zscale         = 1e-14\nZresolution    = -1\nCompression    = 0\nDataType       = 6\nCheckType      = 0\n*\n"
      "0 100000000 BAD \n300000000 -400000000 500000000 \n\n*\n \n*\n",
      "m.sdf");
  EXPECT_EQ(mountains.along, 3U);
  EXPECT_EQ(mountains.across, 2U);
  EXPECT_EQ(mountains.spacing_along, 1e-6);
  EXPECT_EQ(mountains.spacing_across, 2e-6);
  EXPECT_TRUE(std::isnan(mountains.at(2, 0)));
  EXPECT_NEAR(mountains.at(1, 1), -4e-6, 1e-18);
  const HeightMap gwyddion = parse_sdf(
      "aBCR-1.0\nManufacID   = Gwyddion\nCreateDate  = 261120261744\nModDate     = 261120261744\nNumPoints   = 2\n"
      "NumProfiles = 2\nXscale      = 4e-06\nYscale      = 5e-06\nZscale      = 1\nZresolution = -1\n"
      "Compression = 0\nDataType    = 3\nCheckType   = 0\n*\n1e-06\n2e-06\n3e-06\n4e-06\n",
      "g.sdf");
  EXPECT_EQ(gwyddion.at(1, 0), 2e-6);
  EXPECT_EQ(gwyddion.at(0, 1), 3e-6);
  const HeightMap profile = parse_sdf(
      "aISO-2.0\nNumPoints = 3\nNumProfiles = 1\nXscale = 1e-6\nYscale = 0\nZscale = 1e-6\n; a comment\n*\n1 2 3\n*\n",
      "p.sdf");
  EXPECT_EQ(profile.across, 1U);
}

TEST(SdfFile, NamesFileAndLineOfWhatIsWrong) {
  const std::string sound =
      "aISO-1.0\nNumPoints = 2\nNumProfiles = 2\nXscale = 1e-6\nYscale = 1e-6\nZscale = 1\n*\n1 2\n3 4\n*\n";
  EXPECT_EQ(parse_sdf(sound, "map.sdf").at(1, 1), 4.0);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = sound;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "map.sdf: is empty"},
      {with("aISO", "bISO"), "map.sdf:1: is a binary"},
      {with("aISO-1.0", "aISO-9.0"), "map.sdf:1: does not begin"},
      {with("NumPoints = 2\n", ""), "map.sdf: NumPoints: the header lacks it"},
      {with("NumPoints = 2", "NumPoints = 2.5"), "map.sdf:2: NumPoints"},
      {with("NumPoints = 2", "NumPoints = -2"), "map.sdf:2: NumPoints"},
      {with("NumPoints = 2", "NumPoints = 0"), "map.sdf:2: NumPoints"},
      {with("NumPoints = 2", "NumPoints = 18446744073709551615"), "fewer heights than"},
      {with("NumPoints = 2", "NumPoints = 3"), "map.sdf:7: has fewer heights than NumPoints times NumProfiles"},
      {with("NumPoints = 2", "NumPoints = 1"), "map.sdf:9: has more heights"},
      {with("Xscale = 1e-6", "Xscale = 0"), "map.sdf:4: Xscale"},
      {with("Yscale = 1e-6", "Yscale = wide"), "map.sdf:5: Yscale"},
      {with("Zscale = 1", "Zscale = nan"), "map.sdf:6: Zscale"},
      {with("Zscale = 1\n", "Zscale = 1\nCompression = 1\n"), "map.sdf:7: Compression: must be 0"},
      {with("Zscale = 1\n", "Zscale = 1\nxscale = 1\n"), "map.sdf:7: xscale: stands twice"},
      {with("Zscale = 1\n", "Zscale\n"), "map.sdf:6: is no NAME = VALUE"},
      {with("\n3 4\n", "\n3 four\n"), "map.sdf:9: height: \"four\" is no number"},
      {with("\n3 4\n", "\n3 inf\n"), "map.sdf:9: height"},
      {sound.substr(0, sound.find("Xscale")), "map.sdf:3: ends within the header"},
      {sound.substr(0, sound.size() - 3), "ends after 4 of 4 heights"},  // "4" may be the beginning of "42"
      {with("\n3 4\n", "\n  3    \n"), "map.sdf:10: ends after 3 of 4 heights"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(message_of<InputError>([&] { (void)parse_sdf(text, "map.sdf"); }), HasSubstr(message)) << text;
}

TEST(SdfFile, SpoiltIsReadOrRefused) {
  std::mt19937_64 random(2);
  int read = 0, refused = 0;
  for (int n = 0; n < 3000; ++n) {
    const std::string text = spoilt_text(sdf_of(random_height_map(random)), random);
    try {
      const HeightMap map = parse_sdf(text, "map.sdf");
      ASSERT_EQ(map.heights.size(), map.along * map.across);
      ASSERT_TRUE(map.spacing_along > 0.0 && map.spacing_across > 0.0);
      for (const double height : map.heights) ASSERT_FALSE(std::isinf(height));
      ++read;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 100);
}

TEST(SdfFile, HasNoRoomForMoreThan65535PointsInADirection) {
  HeightMap map{65536, 1, 1e-6, 1e-6, std::vector<double>(65536, 0.0)};
  EXPECT_THROW(sdf_of(map), std::invalid_argument);
  map.along = 65535;
  map.heights.pop_back();
  EXPECT_TRUE(same_map(parse_sdf(sdf_of(map), "map.sdf"), map));
}

}  // namespace
}  // namespace stillcut
