// What the live loop recorded gives its decisions again, bit for bit: whatever comes late, at once or from a clock that
// was set. The loop's own code on a bus and a clock of its own, without threads. It fails where a late message keeps
// its stamp, where diagrams or silences are left out of the recording, and where lost time is told before there is a
// frame (each tried).
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <random>

#include "drivers/can/candump_log.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/live_loop.hpp"
#include "tools/predictor.hpp"
#include "tools/recorded_frames.hpp"
#include "tools/recorder.hpp"
#include "tools/robot_playback.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

// CLOCK_REALTIME of the run.
std::int64_t the_clock_ns = 0;
std::int64_t clock_of_the_run() noexcept { return the_clock_ns; }

class QueueBus final : public CanBus {
 public:
  std::size_t receive(std::span<CanFrame> frames) noexcept override {
    std::size_t n = 0;
    for (; n < frames.size() && !waiting.empty(); ++n) {
      frames[n] = waiting.front();
      waiting.pop_front();
    }
    return n;
  }
  bool send(const CanFrame& /*frame*/) noexcept override { return false; }
  [[nodiscard]] BusState state() const noexcept override { return BusState::up; }
  [[nodiscard]] BusCounters counters() const noexcept override { return {}; }

  std::deque<CanFrame> waiting;
};

std::vector<CanFrame> frames_of(const std::filesystem::path& log) {
  std::vector<CanFrame> frames;
  CandumpReader reader{log};
  for (CanFrame frame; reader.next(frame);) frames.push_back(frame);
  return frames;
}

RobotState state_at(const Cell& cell, std::int64_t stamp_ns, double moved) {
  RobotState state;
  state.stamp_ns = stamp_ns / 1000 * 1000;
  state.tcp_position = {moved, 0.0, 0.0};
  state.feed_direction = 10.0 * moved;  // asks for new lobes as it turns
  state.feed_rate = 0.05;
  state.spindle_speed_rpm = 8500.0;
  state.axial_depth = cell.cut->axial_depth * (1.0 + moved);
  state.radial_depth = kNaN;
  state.milling = cell.cut->milling;
  return state;
}

RobotPath path_at(std::int64_t stamp_ns, double moved) {
  RobotPath path;
  path.stamp_ns = stamp_ns / 1000 * 1000;
  path.count = 1;
  path.points[0].after = 1.2345678;  // no whole microsecond
  path.points[0].feed_direction = 5.0 * moved;
  path.points[0].radial_depth = kNaN;
  return path;
}

// A live run with everything that threads and clocks can do to it, by chance.
class DisturbedRun {
 public:
  DisturbedRun(const Cell& cell, const std::filesystem::path& folder, unsigned seed)
      : cell_{cell}, pipeline_{cell}, predictor_{cell}, random_{seed} {
    RecordingSettings settings;
    settings.folder = folder;
    recorder_.emplace(*channels_, settings, "can0");
    pipeline_.core().add_lobes(predictor_.nominal().diagram);
    loop_.emplace(bus_, pipeline_, *channels_, true, true, true, clock_of_the_run);
  }

  // The frames of a log from the present on, in batches with what happens meanwhile.
  void play(const std::vector<CanFrame>& frames) {
    std::int64_t set_ns = 0;  // somebody sets the clock
    the_clock_ns = kStart_ns - 1;
    for (int i = 0; i < 3; ++i) {  // the machine stands still before anything is heard
      awake_ns_ += 40 * kMillisecond;
      tick();
    }
    for (std::size_t at = 0; at < frames.size();) {
      const std::size_t batch = chance(50) ? 900 : 1 + random_() % 60;  // a flood, or as they come
      for (const std::size_t end = std::min(frames.size(), at + batch); at < end; ++at) {
        CanFrame frame = frames[at];
        frame.stamp_ns += kStart_ns - frames.front().stamp_ns + set_ns;
        newest_ns_ = frame.stamp_ns;
        if (chance(200)) frame.stamp_ns -= 3 * kMillisecond;  // goes back
        if (chance(30)) continue;                             // is lost
        bus_.waiting.push_back(frame);
        if (chance(500)) bus_.waiting.push_back(frame);  // two of one stamp
      }
      if (chance(60)) set_ns += (chance(2) ? -5'000 : 200) * kMillisecond;
      the_clock_ns = newest_ns_ + static_cast<std::int64_t>(random_() % 3'000'000);
      disturb();
      tick();
      if (!chance(40)) continue;  // the frames are long on their way: it looks like silence
      for (std::int64_t i = static_cast<std::int64_t>(random_() % 150); i > 0; --i) {
        the_clock_ns += kMillisecond + (chance(20) ? 3 * kMillisecond : 0);
        if (chance(10)) disturb();
        tick();
      }
    }
    for (int i = 0; i < 700; ++i) {  // silence: data time goes on by the clock
      the_clock_ns += kMillisecond;
      tick();
    }
    recorder_->finish();
  }

  [[nodiscard]] const std::vector<MessageBytes>& decided() const { return decided_; }

 private:
  bool chance(unsigned one_in) { return random_() % one_in == 0; }

  void disturb() {
    const double moved = static_cast<double>(newest_ns_ / kMillisecond % 4000) * 1e-4;
    if (chance(3)) {
      const std::int64_t late = static_cast<std::int64_t>(random_() % 80) * kMillisecond;
      states_.push_back(state_at(cell_, newest_ns_ - late, moved));
      (void)channels_->messages.push(states_.back());
    }
    if (chance(7)) {
      CorrectionAck ack;
      ack.stamp_ns = newest_ns_ - static_cast<std::int64_t>(random_() % 300) * kMillisecond;
      ack.stamp_ns = ack.stamp_ns / 1000 * 1000;
      ack.sequence = static_cast<std::int64_t>(random_() % 5);
      ack.accepted = chance(2);
      ack.reason = short_text("busy");
      (void)channels_->messages.push(ack);
    }
    if (states_.size() > 5 && chance(5)) {  // the model thread: some of what was asked, some of it much later
      if (const auto diagram = predictor_.at(states_[random_() % states_.size()]))
        channels_->lobes.publish({*diagram, recorder_->add_question(encode(predictor_.answered()), false)});
    }
    if (chance(20)) {
      const RobotPath path = path_at(newest_ns_ - 900 * kMillisecond, moved);
      channels_->ahead.publish({predictor_.along(path), recorder_->add_question(encode(path), true)});
    }
  }

  void tick() {
    awake_ns_ += chance(400) ? 40 * kMillisecond : kMillisecond;  // now and then the machine stands still
    loop_->tick(awake_ns_);
    Output output;
    while (channels_->outputs.pop(output)) {
      recorder_->add_output(output);
      if (output.type == Output::Type::event) {
        EXPECT_GE(output.event.stamp_ns, kStart_ns) << "told of a time before the first frame";
        decided_.push_back(encode(output.event));
      }
      if (output.type == Output::Type::correction) decided_.push_back(encode(output.correction));
    }
  }

  const Cell& cell_;
  Pipeline pipeline_;
  Predictor predictor_;
  std::mt19937 random_;
  QueueBus bus_;
  std::unique_ptr<LoopChannels> channels_ = std::make_unique<LoopChannels>();
  std::optional<Recorder> recorder_;
  std::optional<LiveLoop> loop_;
  std::vector<RobotState> states_;
  std::vector<MessageBytes> decided_;
  std::int64_t newest_ns_ = 0, awake_ns_ = kMillisecond;
};

// Events and corrections of a log of published messages, in their order.
std::vector<MessageBytes> decisions_in(const std::filesystem::path& log) {
  std::vector<MessageBytes> decisions;
  LcmLogReader published{log};
  while (const auto event = published.next_event())
    if (event->channel == kEventChannel || event->channel == kCorrectionChannel) decisions.push_back(event->data);
  return decisions;
}

TEST(Recording, GivesTheDecisionsOfADisturbedRunAgain) {
  const DemoCell files;
  files.simulate("4", "0:0,0.2:0,0.3:1.5,0.8:1.5,1.1:3.6,2.1:3.6,2.6:1.5,3.2:3.6,3.8:0");
  files.change("mode = \"shadow\"", "mode = \"active\"");
  const Cell cell = read_cell(files.path() / "cell.toml", {.bus = false});
  const std::vector<CanFrame> frames = frames_of(files.path() / "cut.log");
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const auto folder = files.path() / ("recording-" + std::to_string(seed));
    DisturbedRun run{cell, folder, seed};
    run.play(frames);
    ASSERT_GT(run.decided().size(), 5U);
    const Finished done = stillcut::run(
        {"stillcut", "replay", "cell.toml", "--can", folder.string(), "--publish", "file://again.lcm?mode=w", "--json"},
        files.path());
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const std::vector<MessageBytes> again = decisions_in(files.path() / "again.lcm");
    EXPECT_TRUE(again == run.decided()) << "seed " << seed << ": " << again.size() << " decided again, "
                                        << run.decided().size() << " live; " << done.out << done.err;
  }
}

// Frames alone do not tell what was decided: the test above would see it if messages were left out.
TEST(Recording, WithoutTheRobotsPartDecidesOtherwise) {
  const DemoCell files;
  files.simulate("3", "0:0,0.2:0,0.3:1.5,0.8:1.5,1.1:3.6,2.1:3.6,2.6:0");
  files.change("mode = \"shadow\"", "mode = \"active\"");
  const Cell cell = read_cell(files.path() / "cell.toml", {.bus = false});
  DisturbedRun run{cell, files.path() / "recording", 1};
  run.play(frames_of(files.path() / "cut.log"));
  const RecordedSegments segments = find_segments(files.path() / "recording");
  const Finished done = stillcut::run({"stillcut", "replay", "cell.toml", "--can", segments.can.front().string(),
                                       "--publish", "file://again.lcm?mode=w", "--json"},
                                      files.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const std::vector<MessageBytes> again = decisions_in(files.path() / "again.lcm");
  EXPECT_FALSE(again == run.decided());
}

}  // namespace
}  // namespace stillcut
