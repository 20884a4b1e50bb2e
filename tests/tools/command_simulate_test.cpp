#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/decoder.hpp"
#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "models/milling_simulation.hpp"
#include "models/posture.hpp"
#include "tools/programs.hpp"

namespace stillcut {
namespace {

const std::string kDemoCell = TEST_DATA "/../../examples/demo-cell/cell.toml";

std::filesystem::path temporary(const std::string& name) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  return std::filesystem::path(::testing::TempDir()) / (std::string("stillcut_") + test->name() + "_" + name);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int simulate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"stillcut", "simulate"});
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  testing::internal::CaptureStderr();
  const int code = run_stillcut(static_cast<int>(argv.size()), argv.data());
  testing::internal::GetCapturedStderr();
  return code;
}

TEST(SimulateCommand, RowsAreAsTheContractSaysAndTheSameEveryTime) {
  const auto first = temporary("1.csv"), second = temporary("2.csv");
  for (const auto& file : {first, second})
    ASSERT_EQ(simulate({kDemoCell, "--duration", "0.2", "--csv", file.string(), "--depth", "0:0,0.05:0,0.1:2"}), 0);
  EXPECT_TRUE(bytes_of(first) == bytes_of(second));
  const std::string header = "time_s,fx_n,fy_n,fz_n,x_um,y_um,z_um,chip_um,spindle_speed_rpm\n";
  EXPECT_EQ(bytes_of(first).substr(0, header.size()), header);
  const CsvTable table = read_csv(first);
  const double step = table.number(table.rows()[1], 0);
  EXPECT_LE(step, 1.0 / (20 * 795.0));  // 20 rows a period of the highest mode
  for (std::size_t i = 0; i < table.rows().size(); ++i) {
    const CsvRow& row = table.rows()[i];
    ASSERT_NEAR(table.number(row, 0), static_cast<double>(i) * step, 1e-9);
    ASSERT_NEAR(table.number(row, 8), 8500.0, 1e-4);
    if (table.number(row, 0) < 0.05) {
      ASSERT_EQ(table.number(row, 1), 0.0);
    }
  }
  EXPECT_NEAR(static_cast<double>(table.rows().size()), 0.2 / step + 1, 1.01);
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

TEST(SimulateCommand, TheLogIsWhatTheCellsDecoderReads) {
  const auto log = temporary("cut.log");
  ASSERT_EQ(simulate({kDemoCell, "--duration", "0.5", "--can", log.string(), "--speed", "0:8000", "--noise", "0"}), 0);
  const Cell cell = read_cell(kDemoCell, {.bus = false});
  Decoder decoder(read_dbc(cell.can->dbc), *cell.can, kDemoCell);
  CandumpReader reader(log);
  CanFrame frame;
  Decoded decoded;
  std::int64_t samples = 0, speeds = 0, first_ns = 0, last_ns = 0;
  while (reader.next(frame)) {
    if (first_ns == 0) first_ns = frame.stamp_ns;
    ASSERT_GE(frame.stamp_ns, last_ns);
    last_ns = frame.stamp_ns;
    decoded = {};
    ASSERT_TRUE(decoder.decode(frame, decoded));
    if (decoded.blocks > 0) samples += decoded.block[0].samples;
    if (decoded.has_speed) {
      ++speeds;
      ASSERT_NEAR(rad_s_to_rpm(decoded.spindle.speed), 8000.0, 0.051);
    }
  }
  EXPECT_EQ(reader.frames_bad(), 0);
  EXPECT_EQ(decoder.counters().frames_lost, 0);
  EXPECT_EQ(samples, 12800);  // 25.6 kHz
  EXPECT_EQ(speeds, 26);      // 50 Hz, time 0 included
  EXPECT_NEAR(static_cast<double>(last_ns - first_ns) * 1e-9, 0.5, 1e-6);
  std::filesystem::remove(log);
}

TEST(SimulateCommand, ExitCodesTellWrongUsageFromBadInput) {
  EXPECT_EQ(simulate({kDemoCell}), 2);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "-1"}), 2);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--depth", "0:x"}), 2);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--depth", "1:1,0:1"}), 2);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--depth", "0:-1"}), 2);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--rate", "1000"}), 2);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--csv", "-", "--json"}), 2);
  EXPECT_EQ(simulate({"no-such-cell.toml", "--duration", "0.01"}), 3);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--posture", "nowhere"}), 3);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--plot", "cut.pdf"}), 3);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--csv", "/no/such/folder/cut.csv"}), 3);
  EXPECT_EQ(simulate({kDemoCell, "--duration", "0.01", "--speed", "0:0"}), 3);
}

// rms of what does not repeat with the spindle: the displacement less that of one revolution before, m.
double unrepeated_motion(const MillingSetup& setup, double settle_s, double seconds) {
  constexpr int kRowsPerTurn = 200;
  const double rate_hz = setup.cut.spindle_speed / kTwoPi * kRowsPerTurn;
  MillingSimulation cut(setup, rate_hz);
  for (int i = 0; i < settle_s * rate_hz; ++i) cut.advance();
  std::vector<Eigen::Vector3d> last(kRowsPerTurn);
  for (Eigen::Vector3d& q : last) q = cut.advance().displacement;
  double sum = 0.0;
  const int rows = static_cast<int>(seconds * rate_hz);
  for (int i = 0; i < rows; ++i) {
    const Eigen::Vector3d now = cut.advance().displacement;
    sum += (now - last[static_cast<std::size_t>(i % kRowsPerTurn)]).squaredNorm();
    last[static_cast<std::size_t>(i % kRowsPerTurn)] = now;
  }
  return std::sqrt(sum / rows);
}

const std::string kMachiningRobotCell = TEST_DATA "/../../examples/demo-robot/cell.toml";
const std::string kMachiningRobot = TEST_DATA "/../../examples/demo-robot/robot.urdf";

double peak_y_um(const std::filesystem::path& csv) {
  const CsvTable table = read_csv(csv);
  double peak = 0.0;
  for (const CsvRow& row : table.rows()) peak = std::max(peak, std::abs(table.number(row, 5)));
  return peak;
}

TEST(SimulateCommand, ARobotsTwoIntegratorsAgreeOnASmallCut) {
  const auto whole = temporary("whole.csv"), fast = temporary("fast.csv");
  const std::vector<std::string> cut{kMachiningRobotCell, "--robot", kMachiningRobot, "--duration", "0.3"};
  auto with = [&](const char* integrator, const std::filesystem::path& csv) {
    std::vector<std::string> arguments = cut;
    arguments.insert(arguments.end(), {"--integrator", integrator, "--csv", csv.string()});
    return simulate(arguments);
  };
  ASSERT_EQ(with("whole", whole), 0);
  ASSERT_EQ(with("linearised", fast), 0);
  EXPECT_GT(peak_y_um(whole), 10.0);
  EXPECT_NEAR(peak_y_um(whole), peak_y_um(fast), 0.03 * peak_y_um(fast));
}

TEST(SimulateCommand, RefusesARobotThatCannotStandThereOrFollow) {
  EXPECT_EQ(simulate({kMachiningRobotCell, "--robot", kMachiningRobot, "--duration", "0.1", "--posture", "0,0,0"}), 2);
  EXPECT_EQ(
      simulate({kMachiningRobotCell, "--robot", kMachiningRobot, "--duration", "0.1", "--posture", "0,0,0,0,500,0"}),
      2);
  EXPECT_EQ(simulate({kMachiningRobotCell, "--robot", kMachiningRobotCell, "--duration", "0.1"}), 3);
  EXPECT_EQ(simulate({kMachiningRobotCell, "--robot", "none.urdf", "--duration", "0.1"}), 3);
  EXPECT_EQ(simulate({kMachiningRobotCell, "--duration", "0.1", "--integrator", "whole"}), 2);  // goes with --robot
}

// What the demo tells: the cell's own cut chatters, at a lower depth it does not, and n = 60 f/(N k) is quiet at full
// depth.
TEST(DemoCell, ChattersAtItsOwnSpeedAndNotAtTheCorrectedOnes) {
  const Cell cell = read_cell(kDemoCell, {.bus = false});
  MillingSetup setup;
  setup.tool = *cell.tool;
  setup.material = *cell.material;
  setup.cut = *cell.cut;
  setup.modes = find_posture(read_dynamics_map(cell.dynamics->map), cell.dynamics->posture).modes;
  constexpr double kChatterFrequency = 757.0;  // Hz, of the cut at 8500 rpm
  EXPECT_GT(unrepeated_motion(setup, 1.0, 0.5), 5e-6);
  MillingSetup shallow = setup;
  shallow.cut.axial_depth = 1.5e-3;
  EXPECT_LT(unrepeated_motion(shallow, 1.0, 0.5), 1e-7);
  for (const int k : {2, 3}) {
    MillingSetup corrected = setup;
    corrected.cut.spindle_speed = kTwoPi * kChatterFrequency / (setup.tool.teeth * k);
    EXPECT_GT(corrected.cut.spindle_speed, cell.spindle->min_speed);
    EXPECT_LT(corrected.cut.spindle_speed, cell.spindle->max_speed);
    EXPECT_LT(unrepeated_motion(corrected, 1.0, 0.5), 1e-7) << "k = " << k;
  }
}

}  // namespace
}  // namespace stillcut
