// The results of a sweep -> text, CSV, JSON and a picture.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "runtime/text/json.hpp"
#include "runtime/tool/accuracy/command.hpp"
#include "runtime/tool/accuracy/work_precision.hpp"

namespace cdot {
namespace {

constexpr double useful_agreement = 1e-9;  // a reference serves up to the time of this agreement

double until(const AccuracyReport& report) { return report.reference.times.back(); }

// The step of a way with fixed steps. Samples divide the time evenly, except those of a file.
double step_of(const AccuracyReport& report, const Point& point) {
  return until(report) / static_cast<double>(report.reference.times.size()) / knob_at(point.way, point.level).steps;
}

std::string frontier_text(const AccuracyReport& report) {
  std::string text = fmt::format("\n  {:>8}  {:>9} {:>6}  {:>8} {:>8} {:>10}  {}\n", "error", "us CPU/s", "+-", "|C|",
                                 "|Cdot|", "energy [J]", "the frontier: nothing is cheaper and more accurate");
  for (const std::size_t k : report.frontier_of_world) {
    const Point& point = report.answers[k];
    text += fmt::format("  {:8.1e}  {:9.4g} {:4.0f} %  {:8.1e} {:8.1e} {:10.1e}  {}\n", report.costs[k].error,
                        1e6 * point.cost(), 100 * point.spread(), point.errors.C, point.errors.Cdot,
                        point.errors.energy, knob_text(report, point));
  }
  return text;
}

std::string time_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.3g} us", 1e6 * seconds);
  return seconds < 1 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

// One sentence for all decades that one point serves.
std::string advice_text(const AccuracyReport& report) {
  std::string text = "\n";
  const std::vector<Advice>& advice = report.advice;
  for (std::size_t k = 0; k < advice.size();) {
    std::size_t last = k;
    while (last + 1 < advice.size() && advice[last + 1].point == advice[k].point) ++last;
    const Point& point = report.answers[advice[k].point];
    const std::string range = last == k ? fmt::format("1e{}", advice[k].decade)
                                        : fmt::format("1e{} to 1e{}", advice[k].decade, advice[last].decade);
    text += fmt::format("  for {} use {}: {} per simulated second", range, knob_text(report, point),
                        time_text(point.cost()));
    if (advice[last].factor) text += fmt::format("; ten times more accuracy costs {:.2g}x", *advice[last].factor);
    text += "\n";
    k = last + 1;
  }
  if (advice.empty() && report.compiled.empty()) text += "  no run is accurate to 1e-1\n";
  return text;
}

const Advice* of_decade(const std::vector<Advice>& all, int decade) {
  const auto found = std::ranges::find(all, decade, &Advice::decade);
  return found == all.end() ? nullptr : &*found;
}

// "3.1 us, 7.2 times less"
std::string beside_world(const AccuracyReport& report, const Advice& advice) {
  const double cost = report.answers[advice.point].cost();
  const Advice* const world = of_decade(report.advice, advice.decade);
  if (!world) return time_text(cost);
  const double ratio = report.answers[world->point].cost() / cost;
  return fmt::format("{}, {:.2g} times {}", time_text(cost), ratio < 1 ? 1 / ratio : ratio,
                     ratio < 1 ? "more" : "less");
}

// The gain of compilation at every accuracy, and the ways that could not be compiled.
std::string compiled_text(const AccuracyReport& report) {
  std::string text;
  for (const Advice& advice : report.compiled) {
    text += fmt::format("    1e{:<4} {}: {}", advice.decade, knob_text(report, report.answers[advice.point]),
                        beside_world(report, advice));
    if (const Advice* const lanes = of_decade(report.in_lanes, advice.decade))
      text +=
          fmt::format("; each of {} lanes: {}", report.answers[lanes->point].way.lanes, beside_world(report, *lanes));
    text += "\n";
  }
  if (!text.empty())
    text = fmt::format(
               "\n  compiled: `cdot compile {} --integrator … --step …`, then {}; per simulated second and mechanism\n",
               std::filesystem::path(report.scene.file).filename().string(), compiled_by()) +
           text;
  if (!report.left_out.empty()) text += "\n  not compiled\n";
  for (const std::string& reason : report.left_out) text += "    " + reason + "\n";
  return text;
}

// Each piece of advice once, to be pasted behind `cdot-run simulate SCENE`.
std::string pasted_text(const AccuracyReport& report) {
  std::string text;
  for (std::size_t k = 0; k < report.advice.size(); ++k)
    if (k == 0 || report.advice[k].point != report.advice[k - 1].point)
      text += fmt::format("    1e{:<4} {}\n", report.advice[k].decade,
                          options_text(report, report.answers[report.advice[k].point]));
  return text.empty() ? text : "\n  as options of `cdot-run simulate`\n" + text;
}

std::string searched_text(const AccuracyReport& report) {
  std::string text;
  for (const Searched& one : report.searched)
    text += fmt::format("    {:.0e}  {}, {}: off by {:.1e}, {} per simulated second, and the search before it {} CPU\n",
                        one.choice.asked, name_of(integrators, one.choice.integrator),
                        one.choice.local_error > 0 ? fmt::format("local error {:.0e}", one.choice.local_error)
                                                   : fmt::format("step {:.4g} s", one.choice.step),
                        one.error, time_text(one.cost), time_text(one.choice.cpu_before));
  return text.empty() ? text : "\n  `cdot-run simulate --accuracy` finds by itself\n" + text;
}

using text::Json;

// The numbers of a point, a row each: columns of the CSV file and keys of the JSON.
// clang-format off
struct Column {
  const char* name;
  Json (*value)(const AccuracyReport& report, const Point& point);
};
constexpr Column columns_of_way[] = {
    {"method",      [](auto&, auto& p) { return Json(name_of(p.way)); }},
    {"integrator",  [](auto&, auto& p) { return Json(name_of(integrators, p.way.integrator)); }},
    {"solver",      [](auto&, auto& p) { return Json(name_of(solvers, p.way.solver)); }},
    {"drift",       [](auto&, auto& p) { return Json(name_of(drifts, p.way.drift)); }},
    {"iterations",  [](auto&, auto& p) { return Json(sweeps(p.way.solver) ? p.way.iterations : 0); }},
    {"precision",   [](auto&, auto& p) { return Json(name_of(precisions, p.way.single)); }},
    {"lanes",       [](auto&, auto& p) { return Json(p.way.lanes); }},
    {"step",        [](auto& report, auto& p) { return Json(p.way.adaptive ? 0 : step_of(report, p)); }},
    {"local_error", [](auto&, auto& p) { return Json(knob_at(p.way, p.level).local_error); }},
};
constexpr Column columns_of_answer[] = {
    {"error",          [](auto&, auto& p) { return Json(p.errors.trajectory()); }},
    {"position_error", [](auto&, auto& p) { return Json(p.errors.position); }},
    {"angle_error",    [](auto&, auto& p) { return Json(p.errors.angle); }},
    {"C",              [](auto&, auto& p) { return Json(p.errors.C); }},
    {"Cdot",           [](auto&, auto& p) { return Json(p.errors.Cdot); }},
    {"energy_error",   [](auto&, auto& p) { return Json(p.errors.energy); }},
    {"cpu_per_second", [](auto&, auto& p) { return Json(p.cost()); }},
    {"cpu_spread",     [](auto&, auto& p) { return Json(p.spread()); }},
};
// clang-format on

Json json_of(const AccuracyReport& report, const Point& point) {
  Json json;
  for (const auto& [name, value] : columns_of_way) json[name] = value(report, point);
  json["failure"] = point.failure;
  if (!point.failure.empty()) return json;
  for (const auto& [name, value] : columns_of_answer) json[name] = value(report, point);
  json["rounds"] = point.rounds;
  return json;
}

// Only the name of a way has commas.
std::string csv_cell(const Json& value) {
  if (const auto* number = std::get_if<double>(&value.value)) return fmt::format("{},", *number);
  const auto* text = std::get_if<std::string>(&value.value);
  const bool plain = text && text->find(',') == std::string::npos;
  return (plain ? *text : value.dump()) + ",";
}

std::string csv_row(const AccuracyReport& report, const Point& point, bool best) {
  std::string row;
  for (const auto& [name, value] : columns_of_way) row += csv_cell(value(report, point));
  for (const auto& [name, value] : columns_of_answer)
    row += point.failure.empty() ? csv_cell(value(report, point)) : ",";
  return row + (best ? "1," : "0,") + (point.failure.empty() ? "" : "\"" + point.failure + "\"") + "\n";
}

// Shows whether the motion itself limits the reference.
std::string sensitivity_text(const ReferenceRun& reference) {
  const Sensitivity& s = reference.sensitivity;
  if (!s.known()) return {};
  return fmt::format(
      "                  starts that differ by a relative 1e-9 end {:.1e} apart; by {:.0e}: {:.1e}\n"
      "                  {}\n",
      1e-9 * s.condition, s.slight, s.round_off, reference.verdict);
}

}  // namespace

std::string knob_text(const AccuracyReport& report, const Point& point) {
  const double local = knob_at(point.way, point.level).local_error;
  return name_of(point.way) + (local > 0 ? fmt::format(", local error {:.0e}", local)
                                         : fmt::format(", step {:.4g} s", step_of(report, point)));
}

std::string options_text(const AccuracyReport& report, const Point& point) {
  const Way& way = point.way;
  const Knob knob = knob_at(way, point.level);
  std::string text = fmt::format("--integrator {} --solver {} --drift {} --precision {} --substeps 1",
                                 name_of(integrators, way.integrator), name_of(solvers, way.solver),
                                 name_of(drifts, way.drift), name_of(precisions, way.single));
  if (sweeps(way.solver)) text += fmt::format(" --iterations {}", way.iterations);
  if (way.adaptive) text += fmt::format(" --local-error {:.0e}", knob.local_error);
  return text + fmt::format(" --step {}", step_of(report, point));
}

std::string reference_text(const AccuracyReport& report) {
  const ReferenceRun& reference = report.reference;
  if (reference.disagree.empty()) return fmt::format("  reference       {}, as given\n", reference.made_by);
  const double apart = reference.disagreement();
  std::string text = fmt::format("  reference       {} agree to {:.1e} m, rad\n", reference.made_by, apart);
  if (apart <= wanted_agreement) return text;
  text += fmt::format("                  more than {:.0e} apart: {}\n", wanted_agreement, reference.settled);
  text += sensitivity_text(reference);
  text += fmt::format("                  errors below {:.1e}, ten times the disagreement, count as equal\n",
                      reference.resolution());
  const double good = reference.agreed_until(useful_agreement);
  if (apart > 1e-6 && good > 0)
    text += fmt::format("                  until {0:.4g} s they agree to {1:.0e}: use --until {0:.4g}\n", good,
                        useful_agreement);
  return text;
}

std::string accuracy_text(const AccuracyReport& report) {
  const Scene& scene = report.scene;
  std::string text = fmt::format("{}\n", scene.title.empty() ? scene.file : scene.title);
  text += fmt::format("  bodies, joints  {}, {}\n", scene.bodies.size(), scene.joints.size());
  text += reference_text(report);
  text +=
      fmt::format("  error           the largest |x - x_ref| [m] or angle [rad] of a body, {} times up to {:.6g} s\n",
                  report.reference.times.size(), until(report));
  text += fmt::format("  measured        {} ways: {} runs succeeded, {} failed; medians of {} interleaved rounds\n",
                      report.ways, report.answers.size(), report.failures.size(), report.rounds);
  return text + frontier_text(report) + advice_text(report) + pasted_text(report) + compiled_text(report) +
         searched_text(report);
}

std::string accuracy_json(const AccuracyReport& report) {
  Json points = Json::array(), failures = points, advice = points, compiled = points, left_out = points;
  for (const auto* const all : {&report.compiled, &report.in_lanes})
    for (const Advice& a : *all)
      compiled.push_back({{"error", std::pow(10.0, a.decade)},
                          {"point", a.point},
                          {"lanes", report.answers[a.point].way.lanes},
                          {"cpu_per_second", report.answers[a.point].cost()}});
  for (const std::string& reason : report.left_out) left_out.push_back(Json(reason));
  for (const Point& point : report.answers) points.push_back(json_of(report, point));
  for (const Point& point : report.failures) failures.push_back(json_of(report, point));
  for (const Advice& a : report.advice) {
    Json& one = advice.push_back({{"error", std::pow(10.0, a.decade)},
                                  {"point", a.point},
                                  {"options", options_text(report, report.answers[a.point])}});
    if (a.factor) one["ten_times_more_accuracy_costs"] = *a.factor;
  }
  Json searched = Json::array();
  for (const Searched& one : report.searched) {
    Json& chosen = searched.push_back(choice_json(one.choice));
    chosen["error"] = one.error;
    chosen["cpu_per_second"] = one.cost;
  }
  const Json json = {
      {"scene", report.scene.file},
      {"title", report.scene.title},
      {"until", until(report)},
      {"samples", report.reference.times.size()},
      {"rounds", report.rounds},
      {"reference",
       {{"made_by", report.reference.made_by},
        {"disagreement", report.reference.disagreement()},
        {"condition", report.reference.sensitivity.condition},
        {"round_off", report.reference.sensitivity.round_off},
        {"resolution", report.reference.resolution()}}},
      {"points", points},
      {"failures", failures},
      {"frontier", report.frontier},
      {"advice", advice},
      {"searched", searched},
      {"compiled", compiled},
      {"not_compiled", left_out},
  };
  return json.dump(2) + "\n";
}

std::string accuracy_csv(const AccuracyReport& report) {
  std::string text;
  for (const Column& column : columns_of_way) text += fmt::format("{},", column.name);
  for (const Column& column : columns_of_answer) text += fmt::format("{},", column.name);
  text += "frontier,failure\n";
  for (std::size_t k = 0; k < report.answers.size(); ++k)
    text += csv_row(report, report.answers[k], std::ranges::count(report.frontier, k) > 0);
  for (const Point& point : report.failures) text += csv_row(report, point, false);
  return text;
}

namespace {

// --- The picture: a hue per integrator, a lightness and a marker per way, hollow in float.

constexpr int hues[] = {215, 300, 35, 150, 0, 180, 60, 255};  // by Integrator

std::size_t family_of(const Way& way) { return static_cast<std::size_t>(way.integrator) % std::size(hues); }

// The ways of one integrator, from the first to the last of `count`.
std::string colour_of(std::size_t family, int index, int count) {
  return fmt::format("hsl({} 75% {}%)", hues[family], count < 2 ? 50 : 38 + 28 * index / (count - 1));
}

// The answers come by way.
std::vector<DiagramSeries> series_of(const AccuracyReport& report) {
  std::vector<DiagramSeries> all;
  std::vector<std::size_t> families;
  int count[std::size(hues)] = {};
  for (std::size_t k = 0; k < report.answers.size(); ++k) {
    const Point& point = report.answers[k];
    const std::size_t family = family_of(point.way);
    if (k == 0 || !(point.way == report.answers[k - 1].way)) {
      all.push_back({name_of(point.way), "", count[family]++, point.way.single, {}, {}});
      families.push_back(family);
    }
    all.back().points.push_back(report.costs[k]);
    all.back().notes.push_back(fmt::format("{}: {:.1e}, {:.3g} us", knob_text(report, point), report.costs[k].error,
                                           1e6 * report.costs[k].cost));
  }
  for (std::size_t k = 0; k < all.size(); ++k)
    all[k].colour = colour_of(families[k], all[k].marker, count[families[k]]);
  return all;
}

}  // namespace

std::string accuracy_svg(const AccuracyReport& report) {
  Diagram diagram;
  diagram.title =
      (report.scene.title.empty() ? report.scene.file : report.scene.title) + ": what accuracy costs in time";
  diagram.subtitle = fmt::format("one thread, {:.6g} s simulated, medians of {} interleaved rounds",
                                 report.reference.times.back(), report.rounds);
  diagram.error_label = "error in trajectory [m, rad]";
  diagram.resolution = report.reference.resolution();
  diagram.margin = noticeable;
  diagram.series = series_of(report);
  return work_precision_svg(diagram);
}

}  // namespace cdot
