// From a frame to a decision: the decoder and the core put together for one cell. The daemon's loop and playback both
// drive exactly this, so that what is tuned on recordings is what runs on the machine.
#pragma once

#include <cstdint>

#include "drivers/can/decoder.hpp"
#include "drivers/files/cell.hpp"
#include "rt/core.hpp"

namespace stillcut {

// What monitor and compensator need of a cell. Throws InputError for a section that is missing.
CoreSettings core_settings(const Cell& cell);

// What corrections may ask of the cell: its [compensation], with the spindle's range narrowed to the tool's window of
// cutting speed. Throws InputError where nothing is left of it.
CompensationLimits compensation_limits(const Cell& cell);

class Pipeline {
 public:
  // Reads the cell's DBC. Throws InputError.
  explicit Pipeline(const Cell& cell);

  // Told of the stages from decode to decide; before the first frame.
  void set_probe(const StageProbe& probe) noexcept {
    probe_ = probe;
    core_.set_probe(probe);
  }

  // One frame of the bus, in the order of arrival. Real-time: no allocation, no lock, no system call. True when the
  // frame brought samples or speed (see decoded()).
  bool feed(const CanFrame& frame) noexcept;

  [[nodiscard]] Core& core() noexcept { return core_; }
  [[nodiscard]] const Core& core() const noexcept { return core_; }
  [[nodiscard]] const Decoder& decoder() const noexcept { return decoder_; }
  [[nodiscard]] const Decoded& decoded() const noexcept { return decoded_; }  // of the newest frame

 private:
  StageProbe probe_;
  Decoder decoder_;
  Decoded decoded_;
  Core core_;
};

}  // namespace stillcut
