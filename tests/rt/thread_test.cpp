#include "rt/thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

namespace stillcut {
namespace {

using testing::HasSubstr;

struct Seen {
  int policy = -1, priority = -1, processors = 0;
  char name[16] = {};
};

Seen look_around() {
  Seen seen;
  sched_param parameter{};
  pthread_getschedparam(pthread_self(), &seen.policy, &parameter);
  seen.priority = parameter.sched_priority;
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) seen.processors = CPU_COUNT(&set);
  pthread_getname_np(pthread_self(), seen.name, sizeof seen.name);
  return seen;
}

int first_allowed_processor() {
  cpu_set_t set;
  sched_getaffinity(0, sizeof set, &set);
  int cpu = 0;
  while (!CPU_ISSET(cpu, &set)) ++cpu;
  return cpu;
}

TEST(RealTimeThread, GetsWhatItsReportClaims) {
  Seen seen;
  RealTimeThread thread{{.priority = 42, .cpu = first_allowed_processor(), .lock_memory = false},
                        [&] { seen = look_around(); }};
  thread.join();
  EXPECT_EQ(thread.report().fifo, seen.policy == SCHED_FIFO && seen.priority == 42);
  EXPECT_EQ(thread.report().fifo, seen.policy != SCHED_OTHER);
  EXPECT_TRUE(thread.report().affinity);
  EXPECT_EQ(seen.processors, 1);
  EXPECT_STREQ(seen.name, kLoopThreadName);
  EXPECT_EQ(thread.report().reasons.empty(), thread.report().complete());
}

TEST(RealTimeThread, NamesEachThingItCouldNotHaveAndRunsAllTheSame) {
  bool ran = false;
  RealTimeThread thread{{.priority = 1000, .cpu = 100'000, .lock_memory = false}, [&] { ran = true; }};
  thread.join();
  EXPECT_TRUE(ran);
  EXPECT_FALSE(thread.report().fifo);
  EXPECT_FALSE(thread.report().affinity);
  EXPECT_TRUE(thread.report().memory_locked) << "not asked for";
  EXPECT_FALSE(thread.report().complete());
  EXPECT_THAT(thread.report().reasons, HasSubstr("SCHED_FIFO priority 1000"));
  EXPECT_THAT(thread.report().reasons, HasSubstr("processor 100000"));
}

TEST(RealTimeThread, CanBeJoinedTwiceAndOutlivesItsSettings) {
  int runs = 0;
  {
    RealTimeThread thread{{.lock_memory = false}, [&] { ++runs; }};
    thread.join();
    thread.join();
  }
  EXPECT_EQ(runs, 1);
}

// In a process of its own, because the rights given up do not come back.
TEST(RealTimeThread, DegradesWithReasonsForAnOrdinaryUser) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit none{0, 0}, little{64 * 1024, 64 * 1024};
    setrlimit(RLIMIT_RTPRIO, &none);
    setrlimit(RLIMIT_MEMLOCK, &little);
    if (geteuid() == 0 && setuid(65534) != 0) _exit(1);
    Seen seen;
    RealTimeThread thread{{}, [&] { seen = look_around(); }};
    thread.join();
    const RealTimeReport& report = thread.report();
    const bool fallen_back = !report.fifo && seen.policy == SCHED_OTHER && !report.memory_locked;
    const bool told = report.reasons.find("LimitRTPRIO=80") != std::string::npos &&
                      report.reasons.find("LimitMEMLOCK=infinity") != std::string::npos;
    _exit(!fallen_back ? 2 : !told ? 3 : 0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace stillcut
