#include "tools/tasks_on_threads.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>

namespace stillcut {
namespace {

TEST(TasksOnThreads, EachIsRunOnceOnAnyNumberOfThreads) {
  for (const int jobs : {-1, 1, 3, 200}) {
    std::array<std::atomic<int>, 100> runs{};
    run_tasks(
        runs.size(), jobs, [&](std::size_t i) { ++runs[i]; }, [] {});
    for (const auto& count : runs) EXPECT_EQ(count, 1) << jobs << " threads";
  }
  run_tasks(
      0, 2, [](std::size_t) { FAIL(); }, [] {});
}

TEST(TasksOnThreads, TheErrorToldIsThatOfTheFirstTaskThatFails) {
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::string told;
    try {
      run_tasks(
          64, 4,
          [](std::size_t i) {
            if (i >= 9) throw std::runtime_error(std::to_string(i));
          },
          [] {});
    } catch (const std::runtime_error& error) {
      told = error.what();
    }
    EXPECT_EQ(told, "9");
  }
}

}  // namespace
}  // namespace stillcut
