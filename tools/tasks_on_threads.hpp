// Independent tasks on several threads, with what must not depend on how many: the result, and the error that is told.
#pragma once

#include <cstddef>
#include <functional>

namespace stillcut {

// Runs task(0) to task(count - 1) on `jobs` threads (at least one), taken in this order; `watch` is called on the
// calling thread every 50 ms. After a task has thrown no further one is begun, but those before it are finished, so
// that the exception thrown here is always that of the first such task.
void run_tasks(std::size_t count, int jobs, const std::function<void(std::size_t)>& task,
               const std::function<void()>& watch);

}  // namespace stillcut
