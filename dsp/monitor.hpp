// The chatter monitor: samples and spindle speed in, what the cut is doing and events out. It holds no clock, no
// socket, no thread and no random number: time comes with the data, so a recording gives the live run's decisions bit
// for bit. How it decides: docs/detection.md. After construction nothing here allocates, locks or throws; one thread
// calls it.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "dsp/cut_gate.hpp"
#include "dsp/decay_watch.hpp"
#include "dsp/line_watch.hpp"
#include "dsp/order_watch.hpp"
#include "dsp/sample_clock.hpp"
#include "dsp/sensor_path.hpp"
#include "dsp/signals.hpp"
#include "dsp/spindle_speed.hpp"
#include "dsp/tone.hpp"

namespace stillcut {

struct MonitorSettings {
  std::vector<SensorSettings> sensors;  // at most kMaxSensors
  double highest_speed = 0.0;           // rad/s; far beyond it a reading is implausible; 0: no limit known
  double nominal_speed = 0.0;           // rad/s, used where the cell has no speed signal
  bool has_speed_signal = true;
  int teeth = 0;  // of the tool; 0: unknown
  LineWatchSettings watch{};
  CutGateSettings gate{};
  double release_ratio = 0.35;  // of the limit on S, its mean over some hops: below it chatter has ended
  double release_s = 0.1;       // for this long
};

// What the monitor thinks at the newest hop.
struct MonitorView {
  std::int64_t stamp_ns = 0;  // of the newest sample used
  State state = State::idle;
  double indicator = 0.0;  // 1 is the alarm limit; NaN when it cannot tell
  double speed = 0.0;      // measured, rad/s
  bool chatter = false;    // of the tool
  ChatterKind kind = ChatterKind::unknown;
  bool single_line = true;               // false: chatter in which the tool is thrown about, with no line to answer
  double chatter_frequency_hz = 0.0;     // NaN without chatter
  double chatter_amplitude = 0.0;        // m/s^2
  bool structural = false;               // chatter of the robot's structure, by itself or beside the tool's
  double structural_frequency_hz = 0.0;  // NaN without it
  double decay_per_s = 0.0;              // of the residual mode that dies out slowest in a sound cut; NaN unknown
  double decay_frequency_hz = 0.0;       // of that mode; NaN unknown
  std::uint32_t doubts = kNoDoubt;
  std::int64_t samples_lost = 0;
};

class Monitor {
 public:
  explicit Monitor(const MonitorSettings& settings);

  void set_probe(const StageProbe& probe) noexcept {
    for (Sensor& sensor : sensors_) sensor.path.set_probe(probe);
  }

  // Time zero of notes such as "start=3.612" (the first frame's stamp).
  void set_origin(std::int64_t stamp_ns) noexcept { origin_ns_ = stamp_ns; }

  void add_speed(const SpindleReading& reading) noexcept;
  void add_samples(const SampleBlock& block) noexcept;
  // Time has passed without data: raises the doubts of silence at the moment each fell due.
  void advance(std::int64_t now_ns) noexcept;
  // Prediction as a prior: modes of the present posture and the predicted margin (NaN: unknown).
  void expect(std::span<const ExpectedMode> modes, double margin) noexcept;

  [[nodiscard]] const MonitorView& view() const noexcept { return view_; }
  // Events decided since clear_events(), in order.
  [[nodiscard]] std::span<const Event> events() const noexcept { return {events_.data(), event_count_}; }
  void clear_events() noexcept { event_count_ = 0; }

 private:
  struct Sensor {
    SampleClock clock;
    SensorPath path;
    OrderWatch orders;
    DecayWatch decay;
    int hops_to_orders = 0;
    std::int64_t last_arrival_ns = 0;
    std::int64_t last_loss_event_ns = 0;
    std::int64_t losses = 0;
    bool heard = false;
  };
  enum class Line : std::uint8_t { nothing, on_order, free, wild };
  struct Suspect {  // a line that looks like chatter but has yet to last
    Line line = Line::nothing;
    double frequency_hz = 0.0, cycles = 0.0;  // cycles: phase turned in a revolution
    double peak = 0.0;                        // the largest amplitude since it was suspected, m/s^2
    double evidence = 0.0;                    // gathered in the hops in which it was heard, less those in which not
    std::int64_t since_ns = 0;
  };

  struct Unrepeated {     // power of what does not repeat with the spindle
    double usual = 0.0;   // (m/s^2)^2
    double loud_s = 0.0;  // how long it has been far over that, and over what repeats
  };

  void finish_hop(std::size_t sensor, std::int64_t stamp_ns, double step_s) noexcept;
  void look_for_onset(std::size_t sensor, std::int64_t stamp_ns, double step_s) noexcept;
  bool add_evidence(Suspect& suspect, const Suspect& heard, const Tone& tone, double bin_hz,
                    std::int64_t stamp_ns) const noexcept;
  [[nodiscard]] double evidence_asked(const SensorPath& path, const Suspect& suspect) const noexcept;
  bool look_for_wild_chatter(std::size_t sensor, std::int64_t stamp_ns) noexcept;
  bool begin_wild_chatter(std::size_t sensor, std::int64_t stamp_ns, const LineCandidate& loudest) noexcept;
  bool look_for_unrepeated_chatter(std::size_t sensor, std::int64_t stamp_ns, double step_s) noexcept;
  void follow_orders(std::size_t sensor, bool trusted) noexcept;
  void follow_decay(std::size_t sensor, bool able) noexcept;
  void look_for_forced_vibration(std::size_t sensor, std::int64_t stamp_ns, double step_s) noexcept;
  bool look_for_growing_order(std::size_t sensor, std::int64_t stamp_ns) noexcept;
  void look_for_standing_chatter(std::size_t sensor, std::int64_t stamp_ns) noexcept;
  void follow_chatter(std::int64_t stamp_ns, double step_s) noexcept;
  void listen_to_structure(std::size_t sensor, std::int64_t stamp_ns, bool trusted) noexcept;
  [[nodiscard]] double structural_evidence_asked(const SensorPath& path, double frequency_hz) const noexcept;
  void follow_structural(const SlowWatch& slow, std::int64_t stamp_ns) noexcept;
  void end_structural(std::int64_t stamp_ns, const char* why) noexcept;
  void end_chatter(std::int64_t stamp_ns, const char* why) noexcept;
  void leave_cut(std::int64_t stamp_ns) noexcept;
  void begin_chatter(std::size_t sensor, std::int64_t stamp_ns, const LineCandidate& candidate,
                     const Tone& tone) noexcept;
  [[nodiscard]] double of_forced(const SensorPath& path, const Tone& tone) const noexcept;
  [[nodiscard]] Tone base_line(const SensorPath& path, int axis, const Tone& heard) const noexcept;
  [[nodiscard]] bool speed_confirmed(std::int64_t since_ns) const noexcept;
  [[nodiscard]] double speed_uncertainty() const noexcept;
  [[nodiscard]] Suspect classify(const SensorPath& path, const LineCandidate& candidate,
                                 const Tone& tone) const noexcept;
  [[nodiscard]] bool stands_out_of_the_orders(const SensorPath& path, const LineCandidate& candidate,
                                              double spindle_hz) const noexcept;
  [[nodiscard]] double spindle_hz() const noexcept { return view_.speed / (2.0 * std::numbers::pi); }
  [[nodiscard]] std::span<const ExpectedMode> modes() const noexcept { return {modes_.data(), mode_count_}; }
  [[nodiscard]] double speed_at(std::int64_t stamp_ns) const noexcept;
  [[nodiscard]] double away_from_order(double frequency_hz) const noexcept;
  [[nodiscard]] ChatterKind name_kind(double frequency_hz) const noexcept;
  void report_lost_frames(Sensor& sensor, std::int64_t samples_lost, std::int64_t stamp_ns) noexcept;
  void set_doubts(std::uint32_t mask, std::uint32_t doubts, std::int64_t stamp_ns, double seconds) noexcept;
  [[nodiscard]] std::int64_t silence_due_ns(const Sensor& sensor) const noexcept;
  void update_silence(std::int64_t stamp_ns, double step_s) noexcept;
  void update_speed_doubts(std::int64_t stamp_ns, double step_s) noexcept;
  void emit(std::int64_t stamp_ns, EventType type, ChatterKind kind, double frequency_hz, const char* note) noexcept;

  static constexpr std::size_t kMaxEvents = 64, kMaxModes = 16;
  static constexpr double kOnOrder_hz = 3.0;      // nearer to an order a line cannot be told from it
  static constexpr double kLeastOfForced = 0.01;  // displacement over that of the forced vibration: less is no chatter

  MonitorSettings settings_;
  std::vector<Sensor> sensors_;
  SpindleSpeed speed_;
  CutGate gate_;
  MonitorView view_;
  std::int64_t origin_ns_ = 0, first_sample_ns_ = 0, newest_ns_ = 0;
  std::array<ExpectedMode, kMaxModes> modes_{};
  std::size_t mode_count_ = 0;
  double steady_s_ = 0.0;      // how long speed and contact have been unchanged
  double steady_speed_ = 0.0;  // rad/s, since then
  std::uint32_t speed_fault_ = kNoDoubt;
  std::array<double, kDoubtCount> clear_for_s_{};
  std::array<Suspect, kMaxSensors> suspect_{}, standing_{};
  std::array<int, kMaxSensors> wild_hops_{};
  std::array<Unrepeated, kMaxSensors> unrepeated_{};
  // The order that was told as forced vibration on a mode; 0: none.
  int forced_order_ = 0;
  double until_forced_s_ = 0.0;  // it is looked for again
  // The episode of structural chatter that is open.
  std::size_t structural_sensor_ = 0;
  double structural_below_s_ = 0.0;
  // The episode of chatter that is open.
  std::size_t chatter_sensor_ = 0;
  double heard_hz_ = 0.0;  // of its line in the newest hop; the view gives a running mean
  int hops_heard_ = 0;
  double smooth_ratio_ = 0.0, below_s_ = 0.0, doubt_s_ = 0.0, unseen_s_ = 0.0;
  double largest_amplitude_ = 0.0, largest_order_ratio_ = 0.0;
  bool faded_ = false;
  int free_hops_ = 0, order_hops_ = 0;  // in a row, that its line stood off the spindle's orders, or on one
  bool was_free_ = false;
  std::array<Event, kMaxEvents> events_{};
  std::size_t event_count_ = 0;
};

}  // namespace stillcut
