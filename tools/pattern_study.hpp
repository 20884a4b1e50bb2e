// What `stillcut patterns` answers: which tool path suits the dynamics under it. Patterns over the cell's region and
// paths from files, ranked; the directions to choose at each location; the path put together from the best of them.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/direction_field.hpp"
#include "models/path_plan.hpp"
#include "models/pattern_rating.hpp"
#include "models/region.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {

struct PatternQuestion {
  Cut cut;                                   // the cell's, with what the user set differently
  std::vector<std::filesystem::path> paths;  // further tool paths, files
  double step = 0.0;                         // rad, of directions and of the angles of zig and zig-zag; divides pi
  DirectionMethod method = DirectionMethod::floquet;
  double max_depth = 0.02;            // m
  bool face = false;                  // the tool may go beyond the polygon
  std::vector<std::string> postures;  // ids of those that are the locations; empty: all of the map
  std::optional<double> grid;         // m: locations so far apart instead of the map's postures
  std::optional<double> reach;        // m: how far a location speaks for its surroundings
  double near_optimal = 0.1;          // how much less than the best is nearly as good
  PlanSettings plan;
  double rapid_rate = 0.2;  // m/s
  int threads = 1;
};

enum class PatternSource { lines, loops, file, plan };

struct RatedPattern {
  std::string name;
  PatternSource source = PatternSource::lines;
  std::string file;  // of a path that comes from one
  ToolPath path;
  PathOnLocations on{};
  PatternRating rating{};
};

struct PatternStudy {
  PatternQuestion question;
  std::optional<Region> region;
  CuttingConditions conditions;
  DirectionTable table;
  DirectionField field;
  GlobalChoice global;
  Pocket local_pocket;                 // what the field's directions have in common
  std::vector<RatedPattern> patterns;  // best index first
  PathPlan plan;                       // without patches where no plan is better than the best pattern
  RatedPattern optimized;              // the plan as a path, or the best pattern; without moves: there is no region
  std::string made_of;                 // "3 patches", or the name of the pattern
  std::vector<std::string> warnings;
};

// Throws InputError: no region and no path, a region or path with a fault, a path beyond the locations' reach. The
// result does not depend on the number of threads. `progress` is told the share done, from the calling thread.
PatternStudy study_patterns(const Cell& cell, const PatternQuestion& question,
                            const std::function<void(double)>& progress);

// The pattern of that name, "optimized" for the plan. Throws std::invalid_argument, with the names there are.
const RatedPattern& pattern_named(const PatternStudy& study, const std::string& name);

// The limit at a location along any direction, at a speed, m: of the directions that were computed beside it the lower;
// cut to and fro the lower of both ways.
double limit_along(const DirectionTable& table, std::size_t location, double direction, double spindle_speed,
                   bool to_and_fro = false);

void write_patterns_csv(const PatternStudy& study, std::ostream& out);
nlohmann::ordered_json patterns_json(const PatternStudy& study);
void print_patterns(const PatternStudy& study, std::ostream& out);

// Where to feed and how fast, a row a location: what the runtime proposes from ([compensation] feed_map).
void write_feed_map(const PatternStudy& study, std::ostream& out);

}  // namespace stillcut
