// What the core wants to say during one step, in order, in a fixed store: filled by the core, emptied by whoever drives
// it (the loop hands over to the publisher's ring, playback writes to files). One thread; nothing allocates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "rt/signals.hpp"

namespace stillcut {

class OutputQueue {
 public:
  template <class Item>
  void put(const Item& item) noexcept {
    if (count_ < items_.size()) {
      items_[count_++] = Output{item};
    } else {
      ++overflowed_;
    }
  }
  [[nodiscard]] std::span<const Output> items() const noexcept { return {items_.data(), count_}; }
  void clear() noexcept { count_ = 0; }
  [[nodiscard]] std::uint64_t overflowed() const noexcept { return overflowed_; }

 private:
  std::array<Output, 128> items_{};
  std::size_t count_ = 0;
  std::uint64_t overflowed_ = 0;
};

}  // namespace stillcut
