// stillcut trajectory: how long do these moves take? The fastest jerk-limited move of each case in a file.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "rt/synchronized_motion.hpp"
#include "tools/commands.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/plot_trajectory.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

struct TrajectoryOptions : OutputOptions {
  std::string batch;
  bool together = false;
};

const std::vector<std::string> kPositionColumns{"p0", "v0", "a0", "pf", "vf", "af", "vmax", "amax", "jmax"};
const std::vector<std::string> kVelocityColumns{"v0", "a0", "vf", "af", "amax", "jmax"};

const std::vector<std::string>& columns_of(bool position) { return position ? kPositionColumns : kVelocityColumns; }

// A row's numbers under the names of the columns, in the order of the interface.
struct MoveCase {
  bool position = false;
  std::vector<double> values;
  int line = 0;
};

struct TimedMove {
  double duration_s = kNaN, calc_ns = kNaN;
  TrajectoryError error = TrajectoryError::none;
};

struct Batch {
  bool position = false;
  std::vector<MoveCase> cases;
  std::vector<TimedMove> moves;  // one a case
  std::size_t impossible = 0;
};

// A number that is not finite makes a case impossible; what is no number at all is bad input.
double number_or_not_finite(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const std::string text = table.text(row, column);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (!text.empty() && *end == '\0' && !std::isfinite(value)) return value;
  return table.number(row, column);
}

TimedMove plan_once(const MoveCase& c) {
  const std::vector<double>& x = c.values;
  if (c.position) {
    const PositionPlan plan = plan_position({x[0], x[1], x[2]}, {x[3], x[4], x[5]}, symmetric_limits(x[6], x[7], x[8]));
    return {plan.trajectory.duration(), kNaN, plan.error};
  }
  const VelocityPlan plan = plan_velocity({0.0, x[0], x[1]}, x[2], x[3], {x[4], x[5]});
  return {plan.trajectory.duration(), kNaN, plan.error};
}

// A calculation is shorter than what the clock resolves: the mean of several. Of three such the middle one, as another
// program may have had the processor for a while.
TimedMove plan_timed(const MoveCase& c) {
  constexpr int kCalculations = 8;
  TimedMove move = plan_once(c);
  std::array<double, 3> means{};
  for (double& mean : means) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kCalculations; ++i) move = plan_once(c);
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
    mean = spent.count() / kCalculations;
  }
  std::sort(means.begin(), means.end());
  move.calc_ns = means[1];
  if (move.error != TrajectoryError::none) move.duration_s = kNaN;
  return move;
}

// Which column makes the case impossible.
std::size_t culprit(const MoveCase& c, TrajectoryError error) {
  const std::vector<std::string>& names = columns_of(c.position);
  const auto index = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const auto first_that = [&](auto holds, std::size_t from) {
    const auto found = std::find_if(c.values.begin() + static_cast<std::ptrdiff_t>(from), c.values.end(), holds);
    return static_cast<std::size_t>(found - c.values.begin());
  };
  switch (error) {
    case TrajectoryError::not_finite:
      return first_that([](double x) { return !std::isfinite(x); }, 0);
    case TrajectoryError::limit_not_positive:
      return first_that([](double x) { return !(x > 0); }, c.position ? index("vmax") : index("amax"));
    case TrajectoryError::target_beyond_limit:
      return index("af");
    case TrajectoryError::target_velocity_beyond_limit:
      return index("vf");
    default: {  // the value farthest from 1 in scale
      const auto scale = [](double x) { return x == 0 ? 0.0 : std::abs(std::log(std::abs(x))); };
      const auto found =
          std::max_element(c.values.begin(), c.values.end(), [&](double a, double b) { return scale(a) < scale(b); });
      return static_cast<std::size_t>(found - c.values.begin());
    }
  }
}

AxisTask task_of(const MoveCase& c) {
  const std::vector<double>& x = c.values;
  if (c.position) return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, symmetric_limits(x[6], x[7], x[8])};
  return {{0.0, x[0], x[1]}, {0.0, x[2], x[3]}, symmetric_limits(1.0, x[4], x[5])};
}

// All cases as axes of one motion.
struct JointMotion {
  MotionPlan plan;
  std::vector<AxisTrajectory> trajectories;
};
JointMotion plan_jointly(const std::vector<MoveCase>& cases, bool position, Synchronization synchronization) {
  std::vector<AxisTask> tasks;
  tasks.reserve(cases.size());
  for (const MoveCase& c : cases) tasks.push_back(task_of(c));
  JointMotion motion{{}, std::vector<AxisTrajectory>(cases.size())};
  motion.plan = position ? plan_positions(tasks, motion.trajectories, synchronization)
                         : plan_velocities(tasks, motion.trajectories, synchronization);
  return motion;
}

std::vector<TimedMove> plan_together(const std::vector<MoveCase>& cases, bool position) {
  const auto start = std::chrono::steady_clock::now();
  const MotionPlan plan = plan_jointly(cases, position, Synchronization::time).plan;
  const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
  const bool possible = plan.error == TrajectoryError::none;
  std::vector<TimedMove> moves(cases.size(), {possible ? plan.duration : kNaN, spent.count(), TrajectoryError::none});
  if (!possible) moves[plan.axis].error = plan.error;
  return moves;
}

std::vector<MoveCase> read_cases(const CsvTable& table, bool position) {
  std::vector<std::size_t> columns;
  for (const std::string& name : columns_of(position)) columns.push_back(table.require_column(name));
  std::vector<MoveCase> cases;
  for (const CsvRow& row : table.rows()) {
    MoveCase& c = cases.emplace_back(MoveCase{position, {}, row.line});
    for (std::size_t column : columns) c.values.push_back(number_or_not_finite(table, row, column));
  }
  return cases;
}

Batch plan_batch(const TrajectoryOptions& options) {
  const CsvTable table = read_csv(options.batch);
  Batch batch;
  batch.position = table.find_column("p0").has_value() || table.find_column("pf").has_value();
  batch.cases = read_cases(table, batch.position);
  if (options.together) {
    batch.moves = plan_together(batch.cases, batch.position);
  } else {
    Progress progress("trajectories");
    for (const MoveCase& c : batch.cases) {
      batch.moves.push_back(plan_timed(c));
      progress.update(static_cast<double>(batch.moves.size()) / static_cast<double>(batch.cases.size()));
    }
    progress.finish();
  }
  for (std::size_t i = 0; i < batch.cases.size(); ++i) {
    const TrajectoryError error = batch.moves[i].error;
    if (!std::isfinite(batch.moves[i].duration_s)) ++batch.impossible;
    if (error == TrajectoryError::none) continue;
    const std::string& name = columns_of(batch.position)[culprit(batch.cases[i], error)];
    const InputError reason(options.batch, batch.cases[i].line, name + ": " + describe(error));
    std::cerr << "stillcut: " << reason.what() << '\n';
  }
  return batch;
}

void draw(const Batch& batch, const TrajectoryOptions& options) {
  constexpr std::size_t kMostDrawn = 7;
  std::vector<MoveCase> cases;
  for (std::size_t i = 0; i < batch.cases.size() && cases.size() < kMostDrawn; ++i) {
    if (std::isfinite(batch.moves[i].duration_s)) cases.push_back(batch.cases[i]);
  }
  if (cases.empty()) throw InputError(options.batch, 0, "holds no possible case to draw");
  const JointMotion motion =
      plan_jointly(cases, batch.position, options.together ? Synchronization::time : Synchronization::none);
  std::vector<DrawnMove> moves;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    moves.push_back({motion.trajectories[i], "line " + std::to_string(cases[i].line)});
  }
  plot::write_figure(trajectory_figure(moves, options.together ? "together: all arrive at once" : ""), options.plot);
}

void write_csv(const Batch& batch, const std::string& name) {
  OutputFile file(name);
  file.stream() << "duration_s,calc_ns\n";
  for (const TimedMove& move : batch.moves) {
    write_csv_row(file.stream(), std::array{csv_number(move.duration_s), csv_number(std::round(move.calc_ns))});
  }
  file.finish();
}

// Quantile of the calculation times, ns; NaN without cases.
double calc_quantile(const Batch& batch, double share) {
  std::vector<double> times;
  times.reserve(batch.moves.size());
  for (const TimedMove& move : batch.moves) times.push_back(move.calc_ns);
  if (times.empty()) return kNaN;
  std::sort(times.begin(), times.end());
  return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
}

void print_json(const Batch& batch) {
  nlohmann::ordered_json cases = nlohmann::json::array();
  for (const TimedMove& move : batch.moves) {
    nlohmann::ordered_json one{{"duration_s", move.duration_s}, {"calc_ns", move.calc_ns}};
    if (move.error != TrajectoryError::none) one["impossible"] = describe(move.error);
    cases.push_back(one);
  }
  const nlohmann::ordered_json object{{"interface", batch.position ? "position" : "velocity"},
                                      {"impossible", batch.impossible},
                                      {"calc_ns_p50", calc_quantile(batch, 0.5)},
                                      {"calc_ns_p99", calc_quantile(batch, 0.99)},
                                      {"cases", cases}};
  std::cout << object.dump() << '\n';
}

void print_summary(const Batch& batch) {
  std::printf("%s interface: %zu moves planned, %zu impossible\n", batch.position ? "position" : "velocity",
              batch.moves.size() - batch.impossible, batch.impossible);
  if (batch.moves.empty()) return;
  std::printf("calculation of one: %.0f ns in the middle, %.0f ns for one in a hundred, %.0f ns at most\n",
              calc_quantile(batch, 0.5), calc_quantile(batch, 0.99), calc_quantile(batch, 1.0));
}

void run(const TrajectoryOptions& options) {
  check_output_options(options);
  const Batch batch = plan_batch(options);
  if (!options.csv.empty()) write_csv(batch, options.csv);
  if (!options.plot.empty()) draw(batch, options);
  if (options.json) print_json(batch);
  if (!options.json && options.csv.empty()) print_summary(batch);
}

}  // namespace

void add_trajectory_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("trajectory", "How long jerk-limited moves take: the fastest for each case in a file");
  const auto options = std::make_shared<TrajectoryOptions>();
  command
      ->add_option("--batch", options->batch,
                   "CSV file of cases. Columns p0,v0,a0,pf,vf,af,vmax,amax,jmax: position; v0,a0,vf,af,amax,jmax: "
                   "velocity; any consistent units; other columns are ignored")
      ->required();
  CLI::Option* csv = command
                         ->add_option("--csv", options->csv,
                                      "Write duration and calculation time of each case, nan where it is impossible; - "
                                      "(or nothing) is standard output")
                         ->expected(0, 1);
  command->add_flag("--together", options->together,
                    "The cases are axes of one motion and arrive at once; calculation time is that of all");
  command->add_option("--plot", options->plot, "Draw the first seven moves, to a .svg or .png file");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Example: 100 mm from rest to rest at 500 mm/s, 5 m/s^2 and 100 m/s^3, in mm\n"
      "  printf 'p0,v0,a0,pf,vf,af,vmax,amax,jmax\\n0,0,0,100,0,0,500,5000,100000\\n' > moves.csv\n"
      "  stillcut trajectory --batch moves.csv --csv -");
  command->callback([options, csv] {
    if (csv->count() > 0 && options->csv.empty()) options->csv = "-";
    run(*options);
  });
}

}  // namespace stillcut
