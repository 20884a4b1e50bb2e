// What a recording holds beside the messages of the network, so that playback feeds the core exactly what the live run
// fed: which diagrams it took up, and where data time was moved on in silence.
#pragma once

#include "drivers/lcm/messages.hpp"

namespace stillcut {

inline constexpr const char *kRecordingChannel = "STILLCUT_RECORDING",  // first event of a recording's LCM log
    *kLobesChannel = "STILLCUT_LOBES", *kSilenceChannel = "STILLCUT_SILENCE", *kTimingChannel = "STILLCUT_TIMING";

// Stamps are whole microseconds.
struct LobesUsed {
  std::int64_t fed_ns = 0;            // data time at which the diagram went into the core
  std::int64_t posture_stamp_ns = 0;  // these three as in the diagram itself
  std::int64_t usable_from_ns = 0, usable_until_ns = 0;
  bool ahead = false;
  std::int64_t question = 0;  // number of the question it answers; live only
};

struct Silence {
  std::int64_t first_ns = 0, last_ns = 0;
};
inline constexpr std::int64_t kSilentStep_ns = 1'000'000;

static_assert(std::is_trivially_copyable_v<LobesUsed> && std::is_trivially_copyable_v<Silence>);

// `question`: an encoded RobotState or, ahead, RobotPath; empty where it is not known any more.
MessageBytes encode(const LobesUsed& used, std::span<const std::uint8_t> question);
MessageBytes encode(const Silence& silence);
MessageBytes encode(const LoopTiming& timing);

struct LobesUsedMessage {
  LobesUsed used;
  MessageBytes question;
};
Received<LobesUsedMessage> decode_lobes_used(std::span<const std::uint8_t> bytes);
Received<Silence> decode_silence(std::span<const std::uint8_t> bytes);
Received<LoopTiming> decode_timing(std::span<const std::uint8_t> bytes);

}  // namespace stillcut
