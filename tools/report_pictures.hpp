// Keeps, while a recording is played, the seconds around each onset of chatter for a picture: what the first
// accelerometer felt and what the monitor said. Of many episodes the worst are kept.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tools/plot_replay.hpp"
#include "tools/sample_window.hpp"

namespace stillcut {

class ReportPictures {
 public:
  static constexpr double kBefore_s = 1.0, kAfterOnset_s = 5.0, kAfterEnd_s = 1.0;

  // `blank`: title, rate, teeth and limits of every picture. `done` is told of each that is complete, with its number.
  ReportPictures(ReplayTrace blank, std::function<void(int, ReplayTrace)> done);

  void add(const SampleStretch& stretch);
  void add(const TracePoint& point);
  void add(const ReplayEvent& event);
  void begin(int number, double onset_s);
  void end_chatter(int number, double end_s);  // the picture needs not go on for long
  void finish();                               // the recording ends

 private:
  struct Strip {
    std::array<std::vector<float>, kMaxAxes> axis;
    double end_s = 0.0;  // of the samples
    std::vector<TracePoint> trace;
    std::vector<ReplayEvent> events;
    int number = 0;
    double until_s = 0.0;
  };

  void append(Strip& strip, const SampleStretch& stretch) const;
  void forget_before(Strip& strip, double time_s) const;
  void complete(Strip& strip);

  ReplayTrace blank_;
  std::function<void(int, ReplayTrace)> done_;
  Strip past_;
  std::vector<Strip> open_;
};

}  // namespace stillcut
