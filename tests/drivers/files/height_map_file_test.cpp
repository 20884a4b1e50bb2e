// Height maps through files: the same map comes back to the last bit, and no file breaks the reader.
#include "drivers/files/height_map_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <sstream>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/height_map_cases.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

std::string csv_of(const HeightMap& map) {
  std::ostringstream out;
  write_height_map_csv(out, map);
  return out.str();
}

// Fails with a single digit too few, or a product with 1000 in place of a moved exponent.
TEST(HeightMapCsv, ComesBackToTheLastBit) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 500; ++n) {
    const HeightMap map = random_height_map(random);
    ASSERT_TRUE(same_map(parse_height_map_csv(csv_of(map), "map.csv"), map)) << csv_of(map);
  }
}

TEST(HeightMapCsv, IsWrittenAsAPersonWould) {
  const HeightMap map{2, 2, 4e-6, 5e-6, {-1.25e-6, kNaN, 0.0, 3.0}};
  EXPECT_EQ(csv_of(map), "x_mm,y_mm,z_mm\n0,0,-0.00125\n0.004,0,\n0,0.005,0\n0.004,0.005,3000\n");
}

// As instruments write: other order and origin, rounded places, places without a row, columns of their own.
TEST(HeightMapCsv, FindsTheGridOfAMeasuredMap) {
  const HeightMap map = parse_height_map_csv(
      "z_mm, y_mm ,x_mm,quality\r\n"
      "0.3,7,-9.9,1\r\n0.1,5,-10,1\r\nnan,5,-9.9,1\r\n0.5,5,-9.7,1\r\n0.2,7,-10,1\r\n0.6,7,-9.7,1\r\n",
      "map.csv");
  EXPECT_EQ(map.along, 4U);  // -10, -9.9, -9.8 without a row, -9.7
  EXPECT_EQ(map.across, 2U);
  EXPECT_NEAR(map.spacing_along, 0.1e-3, 1e-15);
  EXPECT_NEAR(map.spacing_across, 2e-3, 1e-15);
  EXPECT_NEAR(map.at(0, 0), 0.1e-3, 1e-15);
  EXPECT_TRUE(std::isnan(map.at(1, 0)));
  EXPECT_TRUE(std::isnan(map.at(2, 0)));
  EXPECT_NEAR(map.at(3, 1), 0.6e-3, 1e-15);
  std::string rounded = "x_mm,y_mm,z_mm\n";
  for (const char* y : {"0", "1"})
    for (const char* x : {"0", "0.0333", "0.0667", "0.1", "0.1333"}) rounded += std::string(x) + "," + y + ",1\n";
  EXPECT_NEAR(parse_height_map_csv(rounded, "map.csv").spacing_along, 0.1333e-3 / 4, 1e-9);
}

TEST(HeightMapCsv, NamesFileAndLineOfWhatIsWrong) {
  const std::string head = "x_mm,y_mm,z_mm\n";
  const std::pair<std::string, std::string> cases[] = {
      {"", "map.csv: is empty"},
      {head, "map.csv: has no row"},
      {"x_mm,y_mm\n0,0\n", "map.csv:1: z_mm: the header lacks"},
      {"x_mm,y_mm,z_m\n0,0,1\n", "map.csv:1: z_m: unknown column; did you mean z_mm?"},
      {head + "0,0,1\n1,0,1\n0,1,1\n1,0,2\n", "map.csv:5: x_mm: this place stands twice"},
      {head + "0,0,1\n1,0,1\n0,1,1\n1,1,high\n", "map.csv:5: z_mm"},
      {head + "0,0,1\n1,0,1\n0,1,1\n1,1,inf\n", "map.csv:5: z_mm"},
      {head + "0,0,1\n1,0,1\n0,1,1\n,1,1\n", "map.csv:5: x_mm"},
      {head + "0,0,1\n1,0,1\n", "map.csv: y_mm: has fewer than two places"},
      {head + "0,0,1\n1,0,1\n2.2,0,1\n0,1,1\n3,1,1\n", "x_mm: lies off the grid"},
      {head + "0,0,1\n1,1,1\n2,2,1\n3,3,1\n4,4,1\n5,5,1\n", "less than a quarter of its grid"},
      {head + "0,0,1\n1e300,0,1\n1e-300,1,1\n2e-300,1,1\n", "map.csv:"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_THAT(message_of<InputError>([&] { (void)parse_height_map_csv(text, "map.csv"); }), HasSubstr(message))
        << text;
}

TEST(HeightMapCsv, SpoiltIsReadOrRefused) {
  std::mt19937_64 random(2);
  int read = 0, refused = 0;
  for (int n = 0; n < 3000; ++n) {
    const std::string text = spoilt_text(csv_of(random_height_map(random)), random);
    try {
      const HeightMap map = parse_height_map_csv(text, "map.csv");
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

struct StlReader {
  std::string bytes;
  std::size_t at = 80;
  std::uint32_t number() {
    std::uint32_t value = 0;
    for (int k = 0; k < 4; ++k)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at++))) << 8 * k;
    return value;
  }
  float part() { return std::bit_cast<float>(number()); }
};

// A tilted plane with a hole: normals, corners, count and size of the file.
TEST(HeightMapStl, HoldsTheKnownTrianglesUpward) {
  HeightMap map{4, 3, 2e-3, 1e-3, {}};
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t i = 0; i < 4; ++i) map.heights.push_back(1e-3 * static_cast<double>(i));  // rises by 1 in 2
  map.at(0, 0) = kNaN;  // a corner of two triangles
  std::ostringstream out;
  write_height_map_stl(out, map);
  StlReader stl{out.str()};
  const std::uint32_t triangles = stl.number();
  EXPECT_EQ(triangles, 12U - 2U);
  ASSERT_EQ(stl.bytes.size(), 84U + 50U * triangles);
  EXPECT_FALSE(stl.bytes.starts_with("solid"));
  for (std::uint32_t t = 0; t < triangles; ++t) {
    EXPECT_NEAR(stl.part(), -1.0 / std::sqrt(5.0), 1e-6);
    EXPECT_NEAR(stl.part(), 0.0, 1e-6);
    EXPECT_NEAR(stl.part(), 2.0 / std::sqrt(5.0), 1e-6);
    for (int corner = 0; corner < 3; ++corner) {
      const float x = stl.part(), y = stl.part(), z = stl.part();
      EXPECT_NEAR(z, 0.5 * x, 1e-5);  // mm
      EXPECT_LE(y, 2.0);
      EXPECT_FALSE(x == 0 && y == 0);
    }
    stl.at += 2;
  }
  EXPECT_EQ(stl.at, stl.bytes.size());
  std::fill(map.heights.begin(), map.heights.end(), kNaN);
  std::ostringstream none;
  write_height_map_stl(none, map);
  EXPECT_EQ(none.str().size(), 84U);
}

TEST(HeightMapFile, IsReadAndWrittenByItsName) {
  const TempFolder folder;
  std::mt19937_64 random(3);
  const HeightMap map = random_height_map(random);
  for (const char* name : {"map.csv", "map.sdf"}) {
    write_height_map(map, folder.path() / name);
    EXPECT_TRUE(same_map(read_height_map(folder.path() / name), map)) << name;
  }
  write_height_map(map, folder.path() / "map.stl");
  EXPECT_GT(std::filesystem::file_size(folder.path() / "map.stl"), 83U);
  const auto write_error = [&](const HeightMap& m, const std::string& name) {
    return message_of<InputError>([&] { write_height_map(m, folder.path() / name); });
  };
  EXPECT_THAT(message_of<InputError>([&] { (void)read_height_map("map.stl"); }), HasSubstr("must end in .csv or .sdf"));
  EXPECT_THAT(write_error(map, "map.x3p"), HasSubstr("must end in .csv, .sdf or .stl"));
  EXPECT_THAT(write_error(map, "no/such/folder.csv"), HasSubstr("cannot be written"));
  EXPECT_THAT(message_of<InputError>([&] { (void)read_height_map(folder.path() / "none.csv"); }),
              HasSubstr("no such file"));
  HeightMap unsound = map;
  unsound.heights.pop_back();
  for (const char* name : {"u.csv", "u.sdf", "u.stl"})
    EXPECT_THAT(write_error(unsound, name), HasSubstr("one height a point"));
  const HeightMap line{3, 1, 1e-3, 1e-3, {1, 2, 3}};
  for (const char* name : {"u.csv", "u.stl"}) EXPECT_THAT(write_error(line, name), HasSubstr("two points"));
}

}  // namespace
}  // namespace stillcut
