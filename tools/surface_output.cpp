#include "tools/surface_output.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "models/cutter_motion.hpp"

namespace stillcut {
namespace {

constexpr double kUm = 1e6;

// One roughness figure by its names and where it stands.
struct FigureName {
  const char *key, *name;
  double unit;  // of one m or of one without a unit
  double (*of)(const SurfaceFigures&);
};
constexpr std::array kProfileFigures{
    FigureName{"ra_um", "R_a", kUm, [](const SurfaceFigures& f) { return f.profiles.mean.ra; }},
    FigureName{"rq_um", "R_q", kUm, [](const SurfaceFigures& f) { return f.profiles.mean.rq; }},
    FigureName{"rt_um", "R_t", kUm, [](const SurfaceFigures& f) { return f.profiles.mean.rt; }},
    FigureName{"rz_um", "R_z", kUm, [](const SurfaceFigures& f) { return f.profiles.mean.rz; }},
    FigureName{"rsk", "R_sk", 1.0, [](const SurfaceFigures& f) { return f.profiles.mean.rsk; }},
    FigureName{"rku", "R_ku", 1.0, [](const SurfaceFigures& f) { return f.profiles.mean.rku; }}};
constexpr std::array kArealFigures{FigureName{"sa_um", "S_a", kUm, [](const SurfaceFigures& f) { return f.area.sa; }},
                                   FigureName{"sq_um", "S_q", kUm, [](const SurfaceFigures& f) { return f.area.sq; }},
                                   FigureName{"sz_um", "S_z", kUm, [](const SurfaceFigures& f) { return f.area.sz; }},
                                   FigureName{"ssk", "S_sk", 1.0, [](const SurfaceFigures& f) { return f.area.ssk; }},
                                   FigureName{"sku", "S_ku", 1.0, [](const SurfaceFigures& f) { return f.area.sku; }}};
constexpr std::array kIntervals{FigureName{"texture_interval_along_mm", "texture interval along", 1e3,
                                           [](const SurfaceFigures& f) { return f.interval_along; }},
                                FigureName{"texture_interval_across_mm", "texture interval across", 1e3,
                                           [](const SurfaceFigures& f) { return f.interval_across; }}};

template <typename Each>
void each_figure(Each each) {
  for (const FigureName& figure : kProfileFigures) each(figure);
  for (const FigureName& figure : kArealFigures) each(figure);
  for (const FigureName& figure : kIntervals) each(figure);
}

// NaN and infinite become null.
nlohmann::ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json figures_json(const SurfaceFigures& figures) {
  nlohmann::ordered_json object;
  each_figure([&](const FigureName& figure) { object[figure.key] = finite_or_null(figure.unit * figure.of(figures)); });
  return object;
}

// Relative to what was measured, as the surface paper counts its errors, but with a sign.
double relative_difference(const FigureName& figure, const StudiedSurface& study, const MeasuredSurface& measured) {
  return (figure.of(study.figures) - figure.of(measured.figures)) / std::abs(figure.of(measured.figures));
}

nlohmann::ordered_json difference_json(const StudiedSurface& study, const MeasuredSurface& measured) {
  nlohmann::ordered_json object;
  each_figure([&](const FigureName& figure) {
    object[figure.key] = finite_or_null(figure.unit * (figure.of(study.figures) - figure.of(measured.figures)));
  });
  return object;
}

nlohmann::ordered_json axes_json(const Eigen::Vector3d& metres) {
  return {{"x", kUm * metres.x()}, {"y", kUm * metres.y()}, {"z", kUm * metres.z()}};
}

std::string said(const char* format, auto... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string spacing_text(double along, double across) {
  if (std::abs(along - across) <= 1e-9 * along) return said("%.3g µm", kUm * along);
  return said("%.3g x %.3g µm", kUm * along, kUm * across);
}

const char* profile_name(const StudiedSurface& study) {
  return study.question.profile == ProfileDirection::across ? "across" : "along";
}

std::string passes_text(const Cut& cut) {
  std::string text =
      said("; feed %.3g mm a tooth, step-over %.3g mm", 1e3 * cut.feed_per_tooth, 1e3 * step_over_of(cut));
  const auto angle = [&](const char* name, double value) {
    if (value != 0.0) text += said(", %s %.3g°", name, rad_to_deg(value));
  };
  angle("tilt", cut.tilt), angle("lead", cut.lead);
  return text;
}

std::string path_text(const SurfaceQuestion& question) {
  std::string text =
      said(" along %s, from X %.4g, Y %.4g mm on, without vibration", question.path.filename().string().c_str(),
           1e3 * question.corner->first, 1e3 * question.corner->second);
  return question.less_envelope ? text + "; less what the ball's body alone would leave" : text;
}

std::string head_text(const StudiedSurface& study) {
  const SurfaceQuestion& question = study.question;
  std::string text = said("%g x %g mm%s%s by a %g mm %s, %d %s", 1e3 * question.along, 1e3 * question.across,
                          study.material.empty() ? "" : " of ", study.material.c_str(), 1e3 * study.tool.diameter,
                          study.tool.shape == ToolShape::ball ? "ball end" : "end mill", study.tool.teeth,
                          study.tool.teeth == 1 ? "tooth" : "teeth");
  text += question.path.empty() ? said(", %.0f rpm", rad_s_to_rpm(study.cut.spindle_speed)) + passes_text(study.cut)
                                : path_text(question);
  text += "\ngrid of " + std::to_string(study.cells.along) + " x " + std::to_string(study.cells.across) + " cells, " +
          spacing_text(question.along / static_cast<double>(study.cells.along),
                       question.across / static_cast<double>(study.cells.across));
  text += std::isfinite(study.error) ? said("; R_a within some %.1g %% of a finer one's", 100.0 * study.error)
                                     : std::string("; no other grid to compare R_a with");
  if (question.points)
    text += "\nresampled to " + std::to_string(question.points->along) + " x " +
            std::to_string(question.points->across) + " points, bilinear";
  text += question.roughness.form == SurfaceForm::linear ? "\nless the least-squares line or plane"
                                                         : "\nless the least-squares polynomial of order two";
  text += question.roughness.cutoff > 0.0 ? said(", λ_c %g mm", 1e3 * question.roughness.cutoff)
                                          : std::string(", no λ_c filter");
  return text;
}

struct Column {
  const char* name;
  const SurfaceFigures* figures;
};

std::string row_text(const FigureName& figure, const std::string& name, const std::vector<Column>& columns) {
  const bool interval = figure.unit == 1e3;
  std::string text = said("%-34s", (name + (figure.unit == kUm ? ", µm" : interval ? ", mm" : "")).c_str());
  // printf counts bytes; µ is two
  if (figure.unit == kUm) text += " ";
  for (const Column& column : columns) {
    const double value = figure.unit * figure.of(*column.figures);
    text += std::isfinite(value) ? said(interval ? "%12.4f" : "%12.4g", value) : said("%14s", "–");
  }
  return text;
}

}  // namespace

nlohmann::ordered_json surface_json(const StudiedSurface& study, const MeasuredSurface* measured) {
  const SurfaceQuestion& question = study.question;
  nlohmann::ordered_json object = figures_json(study.figures);
  object["profile"] = profile_name(study);
  object["form"] = question.roughness.form == SurfaceForm::linear ? "linear" : "quadratic";
  object["cutoff_mm"] = finite_or_null(question.roughness.cutoff > 0.0 ? 1e3 * question.roughness.cutoff : NAN);
  object["path"] = nullptr;
  if (!question.path.empty())
    object["path"] = {{"file", question.path.filename().string()},
                      {"corner_mm", {1e3 * question.corner->first, 1e3 * question.corner->second}},
                      {"less_envelope", question.less_envelope}};
  object["size_mm"] = {1e3 * question.along, 1e3 * question.across};
  object["grid"] = {study.cells.along, study.cells.across};
  object["spacing_um"] = {kUm * question.along / static_cast<double>(study.cells.along),
                          kUm * question.across / static_cast<double>(study.cells.across)};
  object["ra_grid_error_percent"] = finite_or_null(100.0 * study.error);
  object["resampled"] = nullptr;
  if (question.points) object["resampled"] = {question.points->along, question.points->across};
  object["vibration"] = nullptr;
  if (study.vibration)
    object["vibration"] = {{"posture", study.vibration->posture},
                           {"modes", study.vibration->modes},
                           {"mean_um", axes_json(study.vibration->mean)},
                           {"rms_um", axes_json(study.vibration->rms)},
                           {"peak_um", axes_json(study.vibration->peak)}};
  object["without_vibration"] = nullptr;
  if (study.without_vibration) object["without_vibration"] = figures_json(*study.without_vibration);
  if (measured != nullptr) {
    object["measured"] = figures_json(measured->figures);
    object["difference"] = difference_json(study, *measured);
  }
  object["warnings"] = study.warnings;
  return object;
}

void print_surface(const StudiedSurface& study, const MeasuredSurface* measured, std::ostream& out) {
  out << head_text(study) << "\n\n";
  std::vector<Column> columns;
  if (study.vibration) columns.push_back({"vibrating", &study.figures});
  columns.push_back(
      {study.vibration ? "still" : "still tool", study.vibration ? &*study.without_vibration : &study.figures});
  if (measured != nullptr) columns.push_back({"measured", &measured->figures});
  out << said("%-34s", "");
  for (const Column& column : columns) out << said("%12s", column.name);
  if (measured != nullptr) out << said("%12s", "difference");
  out << '\n';
  each_figure([&](const FigureName& figure) {
    const bool of_profiles = figure.name[0] == 'R';
    out << row_text(figure, figure.name + (of_profiles ? std::string(" ") + profile_name(study) : std::string()),
                    columns);
    if (measured != nullptr) {
      const double difference = relative_difference(figure, study, *measured);
      if (std::isfinite(difference)) out << said("%10.1f %%", 100.0 * difference);
    }
    out << '\n';
  });
  if (!study.vibration) return;
  const StudiedVibration& v = *study.vibration;
  out << said("\nvibration at posture %s, %zu modes, in workpiece axes, µm\n", v.posture.c_str(), v.modes)
      << said("%-34s%12s%12s%12s\n", "", "x", "y", "z");
  for (const auto& [name, metres] :
       {std::pair<const char*, const Eigen::Vector3d&>{"mean", v.mean}, {"rms about it", v.rms}, {"peak", v.peak}})
    out << said("%-34s%12.3f%12.3f%12.3f\n", name, kUm * metres.x(), kUm * metres.y(), kUm * metres.z());
}

}  // namespace stillcut
