// Writes into a recording's folder all that went into the core and all that came out, on an ordinary thread: what went
// in from the loop's ring, in its order; the rest from the ordinary threads that have it. A disk that is full or broken
// stops the recording, not the monitor; it goes on, in a new segment, when there is room again.
#pragma once

#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tools/live_loop.hpp"
#include "tools/recording_folder.hpp"

namespace stillcut {

struct RecorderCounters {
  std::int64_t frames = 0, messages = 0;  // written; messages: events of the LCM log
  std::int64_t bytes = 0;                 // on the disk, compressed
  std::int64_t lost = 0;                  // inputs of the core that are not in the recording
  std::int64_t stops = 0;                 // times that the disk refused
  std::int64_t marks = 0;
};

class Recorder {
 public:
  // Throws InputError when the folder cannot be written.
  Recorder(LoopChannels& channels, RecordingSettings settings, std::string interface);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Model thread, before it publishes a diagram: what the diagram answers. The number goes with the diagram.
  std::int64_t add_question(MessageBytes question, bool ahead);
  // Any ordinary thread.
  void add_output(const Output& output);  // as it was published; marks what is worth keeping
  void add_path(const RobotPath& path);
  void mark(std::string why);

  // After the loop has ended: the rest.
  void finish();

  [[nodiscard]] RecorderCounters counters() const { return counters_; }  // after finish()

 private:
  struct Message {
    std::int64_t stamp_ns;
    const char* channel;
    MessageBytes bytes;
  };

  void run(const std::stop_token& stop);
  void drain();
  void drain_messages();
  void write(const CanFrame& frame);
  void write(const LobesUsed& used);
  void write(const Silence& silence);
  void write_message(std::int64_t stamp_ns, const char* channel, const MessageBytes& bytes);
  void end_silence();
  void flush(double now_s);
  void begin(double now_s);
  void stop_recording(double now_s);
  void note_lost();
  void note_loop_times();

  LoopChannels& channels_;
  std::string interface_;
  RecordingFolder folder_;
  RecorderCounters counters_;
  std::string can_, lcm_;         // not yet handed to the files
  std::int64_t frames_held_ = 0;  // in can_
  std::optional<Silence> silence_;
  std::int64_t newest_ns_ = 0;  // data time
  std::int64_t lost_told_ = 0;
  std::uint64_t refused_seen_ = 0;
  double next_try_s_ = 0.0, next_flush_s_ = 0.0, next_times_s_ = 0.0;

  std::mutex mutex_;
  std::vector<Message> messages_;
  std::vector<std::string> marks_;
  std::array<std::map<std::int64_t, MessageBytes>, 2> questions_;  // of the posture, ahead
  std::int64_t last_question_ = 0;
  std::jthread thread_;
};

}  // namespace stillcut
