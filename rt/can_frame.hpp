// A CAN or CAN FD frame with its receive stamp: what every bus delivers and what a candump log holds.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

namespace stillcut {

struct CanFrame {
  // As in linux/can.h, so that a log line and a socket give the same word.
  static constexpr std::uint32_t kExtended = 0x80000000U;
  static constexpr std::uint32_t kRemote = 0x40000000U;
  static constexpr std::uint32_t kError = 0x20000000U;

  std::int64_t stamp_ns = 0;  // whole microseconds: what a candump log can hold, so that live and playback agree
  std::uint32_t id = 0;       // identifier with the flag bits above
  std::uint8_t length = 0;    // data bytes, 0..64
  std::uint8_t fd_flags = 0;  // 1 BRS, 2 ESI, 4 FDF; compare under 0x03
  bool fd = false;
  std::array<std::uint8_t, 64> data{};

  [[nodiscard]] bool is_error() const noexcept { return (id & kError) != 0; }
};

static_assert(std::is_trivially_copyable_v<CanFrame>);

}  // namespace stillcut
