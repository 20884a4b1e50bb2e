// One raw CAN socket of the Linux kernel: opening it with all that a monitor wants to know, and reading what is
// waiting.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rt/can_frame.hpp"

namespace stillcut {

// Whether this kernel has AF_CAN raw sockets.
bool kernel_has_can();

// The interface's number in the kernel, 0 when there is none of that name. A re-created interface gets a new number.
unsigned interface_index(const std::string& interface);

enum class InterfaceState : std::uint8_t { up, down, gone };
InterfaceState interface_state(const std::string& interface);

// Opens and binds a socket: CAN FD on; only frames with `ids` (empty: all) and error frames that tell of the bus, the
// controller, restarts and missing acknowledgement; receive stamps; the kernel's drop counter; a receive buffer of 8
// MiB, or as much as an ordinary user may have. Returns the descriptor, or -1 with errno set.
int open_can_socket(unsigned index, std::span<const std::uint32_t> ids);

// What recvmmsg fills: made once, used by one thread.
class CanBatch {
 public:
  static constexpr unsigned kFrames = 32;

  CanBatch();

  struct Result {
    std::size_t frames = 0;    // that were written to the front of the span
    std::size_t received = 0;  // from the kernel, those that were no frame included
    std::int64_t dropped = 0;  // by the kernel since the last call
    int error = 0;             // errno when nothing was received; 0 or EAGAIN: nothing was waiting
  };

  // Up to kFrames waiting frames, oldest first. One system call (recvmmsg), never blocks, allocates nothing.
  //
  // Stamps: a hardware stamp if the socket's first frame had one, else the kernel's software stamp; never a mix, since
  // the two run on different clocks. A frame without the chosen stamp (error frames are made by the driver) takes the
  // one before it. Cut to whole microseconds, which is what a candump log holds, so that a recording decides as the
  // live run.
  Result receive(int descriptor, std::span<CanFrame> frames) noexcept;

  // Forgets drop count and stamp source: the next call is on another socket.
  void reset() noexcept;

 private:
  struct Impl;  // kernel structures stay out of this header
  struct Delete {
    void operator()(Impl* impl) const noexcept;
  };
  std::unique_ptr<Impl, Delete> impl_;
};

// Sends one frame without waiting; false when the queue is full or the interface cannot send.
bool send_frame(int descriptor, const CanFrame& frame) noexcept;

}  // namespace stillcut
