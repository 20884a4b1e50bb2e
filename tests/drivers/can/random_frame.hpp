// Random CAN frames of every kind, for tests.
#pragma once

#include <random>

#include "rt/can_frame.hpp"

namespace stillcut {

inline CanFrame random_frame(std::mt19937_64& random) {
  const auto below = [&random](std::uint64_t n) { return random() % n; };
  CanFrame frame;
  frame.stamp_ns = static_cast<std::int64_t>(below(9'000'000'000)) * 1'000'000'000 +
                   static_cast<std::int64_t>(below(1'000'000)) * 1'000;
  const std::uint64_t kind = below(5);
  if (kind == 0) {
    frame.id = CanFrame::kError | static_cast<std::uint32_t>(below(0x20000000));
  } else {
    frame.id = below(2) == 0 ? static_cast<std::uint32_t>(below(0x800))
                             : CanFrame::kExtended | static_cast<std::uint32_t>(below(0x20000000));
  }
  if (kind == 1) {
    frame.id |= CanFrame::kRemote;
    frame.length = static_cast<std::uint8_t>(below(9));
    return frame;
  }
  frame.fd = kind >= 3;
  frame.fd_flags = frame.fd ? static_cast<std::uint8_t>(below(16)) : 0;
  frame.length = static_cast<std::uint8_t>(below(frame.fd ? 65 : 9));
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
  return frame;
}

inline bool same_frame(const CanFrame& a, const CanFrame& b) {
  return a.stamp_ns == b.stamp_ns && a.id == b.id && a.length == b.length && a.fd == b.fd && a.fd_flags == b.fd_flags &&
         a.data == b.data;
}

}  // namespace stillcut
