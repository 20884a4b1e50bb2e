#include "tools/tasks_on_threads.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <vector>

namespace stillcut {

void run_tasks(std::size_t count, int jobs, const std::function<void(std::size_t)>& task,
               const std::function<void()>& watch) {
  std::vector<std::exception_ptr> failures(count);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  const auto work = [&] {
    while (!failed) {
      const std::size_t index = next++;
      if (index >= count) return;
      try {
        task(index);
      } catch (...) {
        failures[index] = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::future<void>> workers;
  for (int i = 0; i < std::max(1, jobs); ++i) workers.push_back(std::async(std::launch::async, work));
  for (auto& worker : workers) {
    while (worker.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) watch();
    worker.get();
  }
  for (const auto& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace stillcut
