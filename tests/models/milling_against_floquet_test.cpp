// Milling in time against the Floquet solution, which knows nothing of it: verdicts and growth rates of random cuts,
// end mills and ball ends, straight and helical, of equal and unequal pitch, with and without process damping.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "models/eigenvalues.hpp"
#include "models/floquet.hpp"
#include "models/milling_simulation.hpp"
#include "models/receptance.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

constexpr int kFewest = 16;     // periods in which a growth can be told
constexpr double kFeed = 1e-3;  // m a tooth, large beside all vibration, so that no tooth leaves the part

struct RandomCut {
  MillingSetup setup;
  double period = 0.0;  // s: from tooth to tooth, or of the spindle where the pitch varies
  bool uneven = false;
};

RandomCut random_milling(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  const auto chance = [&](double share) { return uniform(0.0, 1.0) < share; };
  RandomCut result;
  MillingSetup& setup = result.setup;
  Tool& tool = setup.tool;
  tool.shape = chance(0.25) ? ToolShape::ball : ToolShape::end;
  tool.teeth = std::uniform_int_distribution<int>(1, 4)(random);
  tool.diameter = uniform(0.008, 0.03);
  tool.pitch.assign(static_cast<std::size_t>(tool.teeth), kTwoPi / tool.teeth);
  result.uneven = tool.teeth > 1 && chance(0.3);
  if (result.uneven) {
    const double by = uniform(0.01, 0.06) * kTwoPi / tool.teeth;
    tool.pitch.front() += by;
    tool.pitch.back() -= by;
  }
  if (chance(0.5)) tool.helix = deg_to_rad(uniform(10, 40));
  setup.material.ktc = uniform(5e8, 1.5e9);
  setup.material.krc = uniform(1e8, 5e8);
  setup.material.kac = chance(0.5) ? uniform(0.0, 3e8) : 0.0;
  if (chance(0.25)) setup.material.process_damping = uniform(0.0, 2e4);
  Cut& cut = setup.cut;
  cut.milling = static_cast<Milling>(std::uniform_int_distribution<int>(1, 3)(random));
  cut.radial_depth = uniform(0.05, 1.0) * tool.diameter;
  cut.axial_depth = std::exp(uniform(std::log(3e-4), std::log(tool.shape == ToolShape::ball ? 4e-3 : 6e-3)));
  cut.feed_per_tooth = kFeed;
  cut.spindle_speed = rpm_to_rad_s(uniform(2000, 12000));
  cut.feed_direction = uniform(0.0, kTwoPi);
  const int modes = std::uniform_int_distribution<int>(1, 4)(random);
  for (int i = 0; i < modes; ++i) {
    const Eigen::Vector3d u = Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-0.3, 0.3)).normalized();
    setup.modes.push_back({kTwoPi * uniform(40, 900), uniform(0.01, 0.06), uniform(2e6, 3e7), {u.x(), u.y(), u.z()}});
  }
  result.period = kTwoPi / cut.spindle_speed / (result.uneven ? 1 : tool.teeth);
  return result;
}

// The largest multiplier of a linear map, from successive vectors d(n+1) = A d(n): the map as it acts within the space
// that the vectors span, of which directions below `kNoise` are left out (dynamic mode decomposition).
double leading_multiplier_of(const std::vector<Eigen::VectorXd>& vectors) {
  constexpr double kNoise = 3e-3;
  constexpr std::size_t kMost = 30;  // the last ones, where few multipliers are left
  const std::size_t used = std::min(vectors.size() - 1, kMost), first = vectors.size() - 1 - used;
  const auto count = static_cast<Eigen::Index>(used);
  Eigen::MatrixXd from(vectors.front().size(), count), to(vectors.front().size(), count);
  for (std::size_t i = 0; i < used; ++i) {
    const double scale = 1.0 / vectors[first + i].norm();
    from.col(static_cast<Eigen::Index>(i)) = scale * vectors[first + i];
    to.col(static_cast<Eigen::Index>(i)) = scale * vectors[first + i + 1];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(from.transpose() * from);
  Eigen::Index rank = 0;
  while (rank < count && gram.eigenvalues()[count - 1 - rank] > kNoise * kNoise * gram.eigenvalues()[count - 1]) ++rank;
  const Eigen::MatrixXd basis =
      gram.eigenvectors().rightCols(rank) * gram.eigenvalues().tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  return eigenvalues(basis.transpose() * (from.transpose() * to) * basis).cwiseAbs().maxCoeff();
}

struct Growth {
  int periods = 0;      // that the disturbance was followed for
  double factor = 0.0;  // a period; told from kFewest periods on
  bool died = false;    // the disturbance; where the cut never settled, its own unrest
  double unlike = 0.0;  // how far neighbouring teeth vibrate apart in the steady cut, beside the feed
};

// How a cut that was struck departs from one that was not, from period to period. The depth comes on over `ramp`
// periods, so that little moves apart from the disturbance. The blow comes when the cut itself repeats to `settled` of
// the feed from one period to the next; the comparison ends when that is over, when a tooth may leave the part, or when
// the disturbance is lost in rounding.
Growth growth_in_time(const RandomCut& cut, int ramp, double settled) try {
  constexpr int kPeriods = 50, kPatience = 60;
  constexpr double kLost = 2e-8, kSmall = 4e-4;  // of the feed
  constexpr double kStiff = 3e7,
                   kFrequency = kTwoPi * 500;  // a blow on such a mode moves it by some hundred-thousandths
  const auto samples = static_cast<int>(std::ceil(cut.period * lowest_sample_rate_hz(cut.setup.modes))) + 24;
  MillingSetup setup = cut.setup;
  setup.deepest = setup.cut.axial_depth;
  setup.cut.axial_depth = 0.0;
  MillingSimulation quiet(setup, samples / cut.period), struck(setup, samples / cut.period);
  std::vector<Eigen::VectorXd> departures;
  Eigen::VectorXd before = Eigen::VectorXd::Zero(3 * samples);
  const std::vector<double>& pitch = setup.tool.pitch;
  const double longest_feed = kFeed * setup.tool.teeth * *std::max_element(pitch.begin(), pitch.end()) / kTwoPi;
  Growth growth;
  int struck_at = 0;
  double first_change = 0.0;
  for (int period = 0; period < ramp + kPatience || (struck_at > 0 && period < struck_at + kPeriods); ++period) {
    Eigen::VectorXd departure(3 * samples), motion(3 * samples);
    double thickest = 0.0;
    for (int i = 0; i < samples; ++i) {
      MillingConditions conditions = quiet.conditions();
      const double come_on = std::min(1.0, (period + (i + 1.0) / samples) / ramp);
      conditions.axial_depth = setup.deepest * (0.5 - 0.5 * std::cos(std::numbers::pi * come_on));
      const MillingState& state = quiet.advance(conditions);
      const Eigen::Vector3d calm = state.displacement;
      thickest = std::max(thickest, state.chip);
      motion.segment<3>(3 * i) = calm;
      departure.segment<3>(3 * i) = struck.advance(conditions).displacement - calm;
    }
    // Chatter may repeat as well; a chip of more than the feed tells that the tooth before left some.
    const double change = (motion - before).lpNorm<Eigen::Infinity>();
    const bool repeats = change < settled * kFeed && thickest < (1.05 + settled) * longest_feed;
    before = motion;
    if (period <= ramp) continue;
    if (period == ramp + 1) first_change = change;
    if (struck_at == 0)
      growth.died = change < std::min(0.5 * first_change, 0.02 * kFeed) && thickest < 1.05 * longest_feed;
    if (struck_at == 0 && repeats) {
      struck.structure().strike(Eigen::Vector3d(1.0, 0.7, 0.4) * 2e-5 * kFeed * kStiff / kFrequency);
      struck_at = period;
    } else if (struck_at > 0) {
      const double size = departure.lpNorm<Eigen::Infinity>();
      growth.died = size < kLost * kFeed;
      if (!repeats || size > kSmall * kFeed || growth.died) break;
      departures.push_back(departure);
    }
  }
  growth.periods = static_cast<int>(departures.size());
  if (growth.periods >= kFewest) growth.factor = leading_multiplier_of(departures);
  if (cut.uneven) {
    const int shift = static_cast<int>(std::lround(samples * setup.tool.pitch.front() / kTwoPi));
    for (int i = 0; i < samples; ++i) {
      const int other = (i + shift) % samples;
      growth.unlike = std::max(growth.unlike, (before.segment<3>(3 * i) - before.segment<3>(3 * other)).norm() / kFeed);
    }
  }
  return growth;
} catch (const std::runtime_error&) {
  return {};  // grown beyond what is a machine
}

constexpr int kRandomSeries = test::kSanitized ? 1 : 7;
constexpr int kRandomCuts = test::kSanitized ? 10 : 150;

class MillingAgainstFloquet : public ::testing::TestWithParam<int> {};

// The linear theory knows no tooth that leaves the part. Where unequal pitch makes neighbouring teeth vibrate apart by
// a fiftieth of the feed or more, one of them does, and the cut is not compared; strongly unstable and strongly damped
// ones last too short for a growth rate, and their verdict alone is.
TEST_P(MillingAgainstFloquet, VerdictsAndGrowthAgreeOnRandomCuts) {
  std::mt19937_64 random(5200 + static_cast<unsigned>(GetParam()));
  int verdicts = 0, rates = 0, unstable = 0, balls = 0, uneven = 0;
  double worst = 0.0;
  for (int i = 0; i < kRandomCuts; ++i) {
    const RandomCut cut = random_milling(random);
    const MillingSetup& s = cut.setup;
    const LinearCut linear = linear_cut(s.tool, s.material, s.cut);
    const auto modes = modes_in_feed_frame(s.modes, s.cut.feed_direction);
    const double radius = floquet_point(linear, modes, s.cut.spindle_speed, s.cut.axial_depth).spectral_radius;
    if (radius > 0.98 && radius < 1.02) continue;
    Growth growth;
    const bool ball = s.tool.shape == ToolShape::ball;  // next to its pole the chip is thin and soon lost
    for (const auto& [ramp, settled] : {std::pair(40, 0.02), std::pair(15, 0.1), std::pair(6, 0.2)})
      if (growth.periods < kFewest && !growth.died) growth = growth_in_time(cut, ramp, ball ? 0.05 * settled : settled);
    if (growth.unlike > 0.02) continue;
    const bool grew = growth.periods < kFewest ? !growth.died : growth.factor > 1.0;
    EXPECT_EQ(grew, radius > 1.0) << "cut " << i << ": " << growth.factor << " in time, " << radius << " by Floquet";
    ++verdicts;
    unstable += radius > 1.0;
    balls += ball;
    uneven += cut.uneven;
    if (growth.periods < kFewest) continue;
    EXPECT_NEAR(growth.factor, radius, 0.02 * radius) << "cut " << i;
    worst = std::max(worst, std::abs(growth.factor / radius - 1.0));
    ++rates;
  }
  if (test::kSanitized) return;  // too few cuts for shares
  EXPECT_GE(verdicts, kRandomCuts * 3 / 4);
  EXPECT_GE(rates, kRandomCuts / 2);
  EXPECT_GT(unstable, verdicts / 20);
  EXPECT_GT(balls, verdicts / 10);
  EXPECT_GT(uneven, verdicts / 40);
  std::printf("%d verdicts agree, %d of them unstable; %d growth rates within %.2f %%\n", verdicts, unstable, rates,
              100.0 * worst);
}

INSTANTIATE_TEST_SUITE_P(Series, MillingAgainstFloquet, ::testing::Range(0, kRandomSeries));

}  // namespace
}  // namespace stillcut
