// Counts what a test takes from the heap: replaces operator new and delete of the whole test program, so exactly one of
// its sources may include this.
#pragma once

#include <cstdlib>
#include <new>

namespace {

thread_local bool counting = false;
thread_local long allocations = 0;

}  // namespace

// Replacing operator new sees every container and every std:: allocation; malloc itself stays with the sanitizers. Not
// inlined, so that the compiler takes the pair for what it replaces.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (counting) ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
