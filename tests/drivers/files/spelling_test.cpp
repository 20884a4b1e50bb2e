#include "drivers/files/spelling.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stillcut {
namespace {

TEST(Spelling, CountsSingleLetterChanges) {
  EXPECT_EQ(spelling_distance("teeth", "teeth"), 0);
  EXPECT_EQ(spelling_distance("teth", "teeth"), 1);
  EXPECT_EQ(spelling_distance("tteeth", "teeth"), 1);
  EXPECT_EQ(spelling_distance("teath", "teeth"), 1);
  EXPECT_EQ(spelling_distance("teteh", "teeth"), 1);  // neighbours swapped
  EXPECT_EQ(spelling_distance("TEETH", "teeth"), 1);  // letter case
  EXPECT_EQ(spelling_distance("kitten", "sitting"), 3);
  EXPECT_EQ(spelling_distance("", "abc"), 3);
}

TEST(Spelling, FindsTheNearestNameOnlyWhenItIsNear) {
  const std::vector<std::string> known{"min_rpm", "max_rpm", "diameter_mm"};
  EXPECT_EQ(nearest_name("mn_rpm", known), "min_rpm");
  EXPECT_EQ(nearest_name("diametre_mm", known), "diameter_mm");
  EXPECT_EQ(nearest_name("colour", known), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), known), "");
}

}  // namespace
}  // namespace stillcut
