// One interface to a CAN bus, three kinds behind it: socketcan:IFACE (the kernel), log:FILE (a candump log),
// local:NAME (between two processes on a machine without kernel CAN).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "rt/can_frame.hpp"

namespace stillcut {

struct BusCounters {
  std::int64_t frames = 0;      // delivered
  std::int64_t frames_bad = 0;  // log: lines that are no frame; socket: frames cut short
  std::int64_t dropped = 0;     // by the kernel's receive buffer or the local ring, as counted there
  std::int64_t error_frames = 0;
  std::int64_t bus_off = 0;
  std::int64_t reopened = 0;  // the interface vanished and came back
};

enum class BusState : std::uint8_t { up, down, gone, ended };  // ended: a log was read to its end

class CanBus {
 public:
  virtual ~CanBus() = default;

  // Real-time thread. Fills `frames` with what is waiting, oldest first, never blocks, allocates nothing.
  // Returns how many; error frames are delivered too (CanFrame::is_error).
  virtual std::size_t receive(std::span<CanFrame> frames) noexcept = 0;

  // Sends one frame (plant, tests); false when the queue is full, the bus is down, or it is a log. Same thread as
  // receive().
  virtual bool send(const CanFrame& frame) noexcept = 0;

  // Any thread.
  [[nodiscard]] virtual BusState state() const noexcept = 0;
  [[nodiscard]] virtual BusCounters counters() const noexcept = 0;
};

// Opens the bus a cell names:
//   socketcan:IFACE     a CAN interface of the kernel
//   log:FILE            a candump log, delivered as fast as it is asked for
//   log:FILE?speed=S    the same in real time (S = 1), or S times as fast; the frames keep the log's stamps
//   local:NAME          frames between processes of one user on this machine; NAME of letters, digits, '-' and '_'
// `ids`, when not empty, are the only identifiers wanted (with CanFrame::kExtended for 29 bits): the kernel then passes
// on no others but error frames. The other kinds deliver all. Throws InputError (bad log) or ComponentError (no such
// interface, no kernel CAN), naming what to do. A socketcan bus starts an ordinary thread that re-opens the interface
// after it was removed.
std::unique_ptr<CanBus> open_can_bus(const std::string& bus, std::span<const std::uint32_t> ids = {});

}  // namespace stillcut
