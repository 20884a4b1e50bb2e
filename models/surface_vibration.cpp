#include "models/surface_vibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "models/milled_stock.hpp"
#include "models/milling_simulation.hpp"
#include "models/modal_structure.hpp"
#include "models/surface_milling.hpp"
#include "models/surface_sweep.hpp"

namespace stillcut {
namespace {

constexpr double kTimeConstantsSettled = 3.0;  // time constants of the slowest mode
constexpr double kLongestRunIn = 0.5;          // s
constexpr double kSamplesPerMode = 40;         // a period of the highest mode, at least, between which lines are drawn
constexpr double kSamplesPerTooth = 40;
constexpr double kRigid = 1e6;  // times as stiff
constexpr double kTurnsOfMean = 3.0;
constexpr std::size_t kMostSamples = 50'000'000;  // of 12 bytes
constexpr double kReachRoom = 1.3;                // of the largest displacement that was seen before
constexpr int kMostRounds = 4;
constexpr std::size_t kProgressSamples = 4096;

double highest_hz(const std::vector<Mode>& modes) {
  double highest = 0.0;
  for (const Mode& mode : modes) highest = std::max(highest, mode.natural_frequency / kTwoPi);
  return highest;
}

double run_in_time(const std::vector<Mode>& modes) {
  double slowest = std::numeric_limits<double>::infinity();  // 1/s
  for (const Mode& mode : modes) slowest = std::min(slowest, mode.natural_frequency * mode.damping_ratio);
  return std::min(kLongestRunIn, kTimeConstantsSettled / slowest);
}

double sample_rate_hz(const CutterMotion& motion, const std::vector<Mode>& modes) {
  return std::max(kSamplesPerMode * highest_hz(modes),
                  kSamplesPerTooth * motion.tool.teeth * motion.spindle_speed / kTwoPi);
}

// Displacements of the passes, without their run-ins, one pass after the other, and what they amount to.
class Recorder {
 public:
  Recorder(double step, std::size_t expected) : step_{step} { samples_.reserve(expected); }

  void add(const Eigen::Vector3d& displacement, bool counts) {
    samples_.emplace_back(displacement.cast<float>());
    if (!counts) return;
    ++counted_;
    sum_ += displacement;
    squares_ += displacement.cwiseAbs2();
    peak_ = peak_.cwiseMax(displacement.cwiseAbs());
  }
  [[nodiscard]] double time() const { return static_cast<double>(samples_.size()) * step_; }  // s, of the next sample

  SurfaceVibration finish(std::vector<CutterPass> passes) {
    SurfaceVibration result;
    const auto count = static_cast<double>(std::max<std::size_t>(1, counted_));
    result.mean = sum_ / count;
    result.rms = (squares_ / count - result.mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    result.peak = peak_;
    result.passes = std::move(passes);
    result.displacement = sampled_displacement(0.0, step_, std::move(samples_));
    result.displacement.reach = peak_;  // what is asked of it lies in the passes
    return result;
  }

 private:
  double step_;
  std::vector<Eigen::Vector3f> samples_;
  std::size_t counted_ = 0;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero(), squares_ = sum_, peak_ = sum_;
};

// Mills passes one after the other, `sample()` a sample further: `begin(pass)` with a pass that has its run-in.
template <typename Begin, typename Sample>
SurfaceVibration mill(const VibrationSetup& setup, const CutterMotion& motion, std::vector<CutterPass> passes,
                      double step, Begin begin, Sample sample) {
  const double run_in = motion.feed_rate * run_in_time(setup.modes), run_out = end_reach(setup.tool, setup.cut);
  const double way = motion.feed_rate * step;  // of a sample
  std::size_t expected = 0;
  for (const CutterPass& pass : passes) expected += static_cast<std::size_t>(std::ceil(pass.length / way)) + 3;
  if (expected > kMostSamples)
    throw std::invalid_argument("the passes are too long to be milled in time: " +
                                std::to_string(std::lround(step * static_cast<double>(expected))) +
                                " s of cutting; make the surface smaller, or the feed faster");
  Recorder recorder(step, expected);
  const auto total = static_cast<double>(passes.size());
  std::size_t milled = 0;  // samples, run-ins included: the spindle turns on through them
  for (std::size_t i = 0; i < passes.size(); ++i) {
    CutterPass with_run_in = passes[i];
    with_run_in.begin -= (with_run_in.reversed ? -1.0 : 1.0) * run_in;
    with_run_in.length += run_in + run_out;
    with_run_in.time = static_cast<double>(milled) * step;
    with_run_in.angle = std::remainder(motion.spindle_speed * with_run_in.time, kTwoPi);
    const auto count = static_cast<std::size_t>(std::ceil(with_run_in.length / way));
    bool recorded = false;
    for (std::size_t k = 0; k <= count; ++k, ++milled) {
      const Eigen::Vector3d displacement = k == 0 ? begin(with_run_in) : sample();
      const double travelled = static_cast<double>(k) * way - run_in;
      if (travelled > -way && travelled < passes[i].length + way) {  // one before the pass and one after it
        if (!recorded) passes[i].time = recorder.time() - travelled / motion.feed_rate;
        recorded = true;
        recorder.add(displacement, travelled > 0.0 && travelled < passes[i].length);
      }
      if (setup.progress && k % kProgressSamples == 0)
        setup.progress((static_cast<double>(i) + static_cast<double>(k) / static_cast<double>(count)) / total);
    }
    passes[i].angle = std::remainder(with_run_in.angle + motion.spindle_speed * run_in / motion.feed_rate, kTwoPi);
  }
  return recorder.finish(std::move(passes));
}

// A tool that were let into the middle of a cut all at once would ring, and may fall into another, wilder vibration
// than the one that grows by itself: it begins where the mean force of a cut by a rigid tool bends it to.
void bend_by_mean_force(const SurfaceMillingSetup& setup, std::vector<Mode> modes, Stock stock, const CutterPass& pass,
                        ModalStructure& structure) {
  std::vector<ModalMotion> bent(modes.size());
  std::vector<Mode> rigid = modes;
  for (Mode& mode : rigid) mode.stiffness *= kRigid;
  ModalStructure held(rigid, setup.step);
  SurfaceMilling milling(setup, stock, held);
  cut_up_to_begin(setup.motion.tool, pass, stock);
  milling.begin(pass);
  const double turn = kTwoPi / setup.motion.spindle_speed;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double counted = 0.0;
  while (milling.time() < kTurnsOfMean * turn) {
    milling.advance();
    if (milling.time() < turn) continue;  // the first leaves what was cut before without feed marks
    sum += milling.force();
    counted += 1.0;
  }
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Eigen::Vector3d direction(modes[i].direction[0], modes[i].direction[1], modes[i].direction[2]);
    bent[i].displacement = direction.normalized().dot(sum / counted) / modes[i].stiffness;
  }
  structure.set_motion(bent);
}

SurfaceVibration mill_with_ball(const VibrationSetup& setup, const CutterMotion& motion,
                                std::vector<CutterPass> passes) {
  // Up-milling meets the part at +y, down-milling at -y of the feed.
  const bool upward = setup.cut.milling != Milling::down;
  std::stable_sort(passes.begin(), passes.end(), [upward](const CutterPass& a, const CutterPass& b) {
    return upward ? a.across < b.across : a.across > b.across;
  });
  const double room = motion.feed_rate * run_in_time(setup.modes) + end_reach(setup.tool, setup.cut);
  std::vector<CutterPass> with_room = passes;  // both ways, for a zig-zag path
  for (CutterPass& pass : with_room) {
    pass.begin -= (pass.reversed ? -1.0 : 1.0) * room;
    pass.length += 2.0 * room;
  }
  Stock stock = stock_for(setup.tool, setup.cut, with_room);
  const double step = longest_step(motion, highest_hz(setup.modes));
  const auto steps_a_sample =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(1.0 / (step * sample_rate_hz(motion, setup.modes))));
  ModalStructure structure(setup.modes, step);
  const SurfaceMillingSetup ball{motion, setup.material, setup.cut.axial_depth, step, setup.force_noise, setup.seed};
  CutterPass first = with_room.front();
  first.angle = 0.0;
  bend_by_mean_force(ball, setup.modes, stock, first, structure);
  SurfaceMilling milling(ball, stock, structure);
  return mill(
      setup, motion, std::move(passes), step * static_cast<double>(steps_a_sample),
      [&](const CutterPass& pass) {
        cut_up_to_begin(setup.tool, pass, stock);
        milling.begin(pass);
        return milling.displacement();
      },
      [&] {
        for (std::int64_t i = 0; i < steps_a_sample; ++i) milling.advance();
        return milling.displacement();
      });
}

// The cut goes on between passes: only where the tool was when matters.
SurfaceVibration mill_with_end_mill(const VibrationSetup& setup, const CutterMotion& motion,
                                    std::vector<CutterPass> passes) {
  MillingSetup cut;
  cut.tool = setup.tool;
  cut.material = setup.material;
  cut.cut = setup.cut;
  cut.modes = setup.modes;
  cut.force_noise = setup.force_noise;
  cut.seed = setup.seed;
  const double rate_hz = sample_rate_hz(motion, setup.modes);
  MillingSimulation milling(std::move(cut), rate_hz);
  const auto sample = [&] { return milling.advance().displacement; };
  return mill(
      setup, motion, std::move(passes), 1.0 / rate_hz, [&](const CutterPass&) { return sample(); }, sample);
}

}  // namespace

SurfaceVibration vibrating_passes(const VibrationSetup& setup, std::vector<CutterPass> passes) {
  if (passes.empty()) throw std::invalid_argument("a surface needs at least one pass");
  if (setup.modes.empty()) throw std::invalid_argument("a simulation needs at least one mode");
  const CutterMotion motion = cutter_motion(setup.tool, setup.cut);
  return setup.tool.shape == ToolShape::ball ? mill_with_ball(setup, motion, std::move(passes))
                                             : mill_with_end_mill(setup, motion, std::move(passes));
}

VibratingCutter vibrating_cutter(const VibrationSetup& setup, double along, double across) {
  VibratingCutter result{cutter_motion(setup.tool, setup.cut), {}};
  // How much it vibrates is first seen in one pass alone.
  std::vector<CutterPass> passes = passes_over(result.motion, setup.cut, along, across);
  Eigen::Vector3d reach = vibrating_passes(setup, {passes.front()}).displacement.reach;
  for (int round = 0; round < kMostRounds; ++round) {
    result.motion.displacement.reach = kReachRoom * reach;
    try {
      passes = passes_over(result.motion, setup.cut, along, across);
    } catch (const std::invalid_argument&) {  // without vibration it is refused above
      throw std::runtime_error("the tool vibrates by " + std::to_string(std::lround(1e6 * reach.norm())) +
                               " um, farther than its ball reaches; the cut is unstable");
    }
    result.vibration = {};  // a large surface's samples are not held twice
    result.vibration = vibrating_passes(setup, passes);
    reach = result.vibration.displacement.reach;
    if ((reach.array() <= result.motion.displacement.reach.array()).all()) {
      result.motion.displacement = result.vibration.displacement;
      return result;
    }
  }
  throw std::runtime_error("the tool vibrates more with every pass; the cut is unstable");
}

}  // namespace stillcut
