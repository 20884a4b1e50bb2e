// Listens to a recording that is played and gathers what the report tells, in memory that is bounded but for the lists
// of cuts and episodes (some hundred bytes each).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "tools/playback.hpp"
#include "tools/report.hpp"
#include "tools/report_pictures.hpp"
#include "tools/report_timeline.hpp"
#include "tools/sample_window.hpp"

namespace stillcut {

class ReportCollector {
 public:
  // `most_pictures`: of the episodes with the highest indicator.
  ReportCollector(const Cell& cell, int most_pictures);

  // Valid as long as the collector.
  [[nodiscard]] PlaybackListener listener();
  [[nodiscard]] Report finish(const PlaybackSummary& played);

 private:
  struct Level {  // rms of the first accelerometer, all axes, over 50 ms, without its offset and slow drift
    double square = 0.0;
    std::int64_t count = 0;
    std::array<double, kMaxAxes> offset{};
    bool begun = false;
  };
  struct SensorSpan {  // what a sensor's rate is measured on: its frames since the last leap in time
    std::int64_t first_ns = 0, last_ns = 0, samples = 0;
    double counted_s = 0.0, counted_samples = 0.0;
    int block = 0;
  };
  struct Asked {  // the correction that is asked for now; episode -1: none
    int episode = -1;
    std::size_t correction = 0;
  };
  struct After {  // levels that follow an episode
    int episode = -1;
    double from_s = 0.0, sum = 0.0;
    int count = 0;
  };

  void hear_frame(const Pipeline& pipeline);
  void hear_samples(const SampleBlock& block, const SampleStretch& stretch);
  void hear_view(const Core& core);
  void hear_output(const Output& output, const Core& core);
  void hear_event(const Event& event, const Core& core);
  void hear_correction(const Correction& correction);
  void hear_robot(const RobotMessage& message);
  void measure_rate(const SampleBlock& block, const SampleStretch& stretch);
  void end_level(double time_s);
  void begin_episode(const Event& event, const Core& core);
  void end_episode(const Event& event, const Core& core);
  void note_fault(const Event& event);
  void keep_picture(int episode, ReplayTrace picture);
  int lobes_in_use(const Core& core);
  [[nodiscard]] double depth_mm(const Core& core) const;
  [[nodiscard]] double seconds(std::int64_t stamp_ns) const;
  ReportCut* open_cut();

  Report report_;
  double nominal_depth_ = 0.0;
  int most_pictures_;
  SampleWindow window_;
  Timeline timeline_;
  ReportPictures pictures_;
  std::vector<SensorSpan> spans_;
  std::vector<int> open_episodes_;
  std::vector<After> after_;
  Asked asked_;
  std::map<std::string, std::size_t> fault_places_;
  Level level_;
  double newest_level_ = kNaN;
  bool in_cut_ = false;
  double cut_speed_sum_ = 0.0, cut_speed_s_ = 0.0, next_lobes_s_ = 0.0;
  std::int64_t origin_ns_ = 0, last_view_ns_ = 0, last_status_ns_ = 0;
};

}  // namespace stillcut
