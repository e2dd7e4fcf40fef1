#include "tests/bench/peers/hard/table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace cdot::peers {
namespace {

constexpr const char* head = R"(# Hard cases beside today's engines

Results of Cdot and of today's engines on the [hard cases](../../hard_cases/README.md). One criterion per case, the code
of that folder, judges all of them. It reads poses and velocities after every step and computes gaps, angles and
energies. Loads of joints are judged only for chains at rest. Bodies, joints, start and step (1/60 s unless the case
states otherwise) are the same for all; there is no contact, damping or sleep unless the case has them. Planar engines
get the planar scene, spatial engines the spatial one or, if the case has only a planar scene, that scene in space. Changes during a run (an impulse, a joint that is added, removed or moved) also change the engine's run. Bullet's
multibodies, MuJoCo and Simbody build their trees once, so they restart from the present state when joints change. A
joint breaks by the load that the engine reports.

An effect is what the engine has for it: a brake its dry friction or a motor of speed 0, a belt the motor of a slider, a
bushing its springs, a rough line or plane its contact. Where an engine has no servo with a greatest torque, its motor
gets the speed that reaches the target in the step; where it has no table, the motor gets the table's speed before each
step. A motor of direct current is a constant torque and a damper for all.

Every engine runs with its defaults and with every useful series of settings from [results](results/README.md), at the
same step. **holds**: with its defaults. *holds, tuned*: with another setting, named below. A number: the number of the
best setting with the largest ratio to its bound, and that bound. *explodes*: a body is not finite, or 10 000 sizes of
the scene away, at that time. *too slow*: the time reached at the end of the CPU time. —: the engine cannot pose the
case, for the reason below. A case that no setting holds was also run at a hundredth of the step, except mechanisms of
more than 50 bodies; this separates errors of the step from other errors. A run gets 30 s of CPU time, and after 60 s
for one case no further setting of an engine starts. Simbody, which is slow here, stops at the first setting that holds,
and so does every engine with more than 150 bodies.

Five rows are invalid problems: a slider without an axis, a motor of a hinge with antiparallel axes, a joint between two
static bodies, a body of mass 0, a distance of 0. An engine may refuse them with an error before the first step:
**refuses**. A hinge between two static bodies may do nothing, a body of mass 0 stand still, and points at distance 0
stay together; the first two only count as *accepted*.

**Fairness.** The bounds are those of Cdot's tests. Many are far below the goals of game engines: a player does not see a
gap of a millimetre. Engines in minimal coordinates (Bullet's multibodies, MuJoCo, Simbody) cannot open the joints of
their trees at all. Cdot's default is the method that the runtime chooses for the mechanism and the step
([recommended.hpp](../../../runtime/include/cdot/recommended.hpp)); it may take many internal steps in one, as Simbody
does. Box2D computes in float and has the bounds for floats.

    cdot-peers-hard -o tests/bench/peers   # this page, and hard_cases.json with all settings; half an hour of CPU time
    cdot-peers-hard --only ball_and_chain --engine ODE

)";

std::string row_of(const hard::Case& hard_case) {
  std::string name = hard_case.fault, scene = hard_case.scene;
  for (const char* dimension : {"planar", "spatial", "_"})
    if (scene.starts_with(dimension)) scene.erase(0, std::string(dimension).size());
  if (!scene.empty()) name += ", " + scene;
  return hard_case.variant.empty() ? name : name + ", " + hard_case.variant;
}

const Engine* engine_of(const std::string& name) {
  for (const Engine& engine : engines())
    if (engine.name == name) return &engine;
  return nullptr;
}

bool is_planar(const hard::Case& hard_case) {
  return hard::Trial(hard_case.fault + "/" + hard_case.scene, {}).scene.dimension == Dimension::planar;
}

// True if the engine refused before the first step, which solves some cases.
bool refused(const Outcome& o) {
  return (o.kind == Outcome::gives_up || o.kind == Outcome::survives) && o.time == 0 && !o.message.empty();
}

// The text in the table, for the best setting.
std::string brief(const Cell& cell) {
  const std::size_t best = cell.best();
  const Outcome& o = cell.settings[best];
  if (o.kind == Outcome::cannot_say) return "—";
  if (o.kind == Outcome::survives && refused(o)) return "**refuses**";
  if (o.kind == Outcome::survives) return best == 0 ? "**holds**" : "holds, tuned";
  if (o.kind == Outcome::wrong && o.worst().bound == 0) return o.worst().what;
  if (o.kind == Outcome::wrong) return fmt::format("{:.1e} > {:.0e}", o.worst().value, o.worst().bound);
  if (refused(o)) return "refuses";
  return fmt::format("{} at {:.2g} s", name_of(o.kind), o.time);
}

// The text below the table.
std::string account(const Outcome& o) {
  if (refused(o)) return (o.kind == Outcome::survives ? "holds, refuses: " : "refuses: ") + o.message;
  if (o.kind == Outcome::survives || o.kind == Outcome::wrong) {
    std::string text = o.kind == Outcome::survives ? "holds: " : "";
    bool first = true;
    for (const hard::Finding& found : o.findings) {
      if (o.kind == Outcome::wrong && found.held() && found.bound != hard::finite_only) continue;
      const bool close = fmt::format("{:.2g}", found.value) == fmt::format("{:.2g}", found.bound);
      const int digits = !found.held() && close ? 6 : 2;
      text += fmt::format("{}{} {:.{}g}", first ? "" : "; ", found.what, found.value, digits);
      if (!found.held()) text += fmt::format(", not {:.{}g}", found.bound, digits);
      first = false;
    }
    return text;
  }
  if (o.kind == Outcome::explodes) return fmt::format("explodes at {:.3g} s", o.time);
  if (o.kind == Outcome::cannot_say) return "cannot say it: " + o.message;
  return fmt::format("{} at {:.3g} s: {}", name_of(o.kind), o.time, o.message);
}

// Explanations of large failures.
struct Remark {
  const char *row, *column, *text;
};
constexpr Remark remarks[] = {
    {"angle_past_half_a_turn", "Box2D", "turns a body by a quarter turn in a step at most, b2_maxRotation"},
    {"angle_past_half_a_turn", "ODE", "a stop below -180 degrees does not act, as its manual says"},
    {"brake_against_motor", "MuJoCo", "the friction of a joint is as soft as a loop, and creeps"},
    {"lopsided_bushing", "Bullet",
     "its springs act by the pose before the step, so the energy of the swing rises and falls by a twelfth"},
    {"axis_not_unit", "Chipmunk",
     "moves bodies before it speeds them up: half a step short of the way, where others are half a step beyond it"},
    {"long_chains_and_trees, chain", "MuJoCo", "its models are XML, which may not be nested so deep"},
    {"long_chains_and_trees, chain at rest", "MuJoCo", "its models are XML, which may not be nested so deep"},
    {"changed_while_running, a joint added", "MuJoCo",
     "the joint is a loop that appears while it runs, as soft as loops are by default"},
    {"bodies_that_cannot_turn", "Chipmunk",
     "the gear that keeps the angle divides by the sum of the inverse moments, which is zero here"},
    {"bodies_that_cannot_turn, falling", "Chipmunk", "the same"},
    {"gimbal_lock, six_dof", "Bullet and ODE",
     "the middle one of their three angles, which the free turn is by default, is singular at 90 degrees"},
    {"pulley_at_zero_rope", "Simbody", "its cables go over wheels, but are springs"},
    {"redundant_hinges", "Simbody",
     "a loop all of whose rows repeat what the tree holds leaves it without a number, closed by balls alone too"},
    {"same_joint_ten_times", "Simbody", "the same"},
    {"scales, 1e-6 m, 1e-9 kg", "Bullet multibody", "takes inertias below 2e-16 for none"},
    {"scales, 1e3 m, 1e6 kg", "Box2D", "moves a body by 2 m in a step at most, b2_maxTranslation"},
    {"scales, 1e6 m, 1e-9 kg", "Box2D", "the same"},
    {"scales, 1e6 m, 1e9 kg", "Box2D", "the same"}};

std::string remarks_on(const Row& row) {
  std::string text;
  for (const Remark& remark : remarks)
    if (row.name == remark.row) text += fmt::format("\n{}: {}.\n", remark.column, remark.text);
  return text;
}

std::string details(const Row& row, const nlohmann::json& cells) {
  std::string text = fmt::format("\n### {}\n\n", row.name);
  text += "| engine | its defaults | its best setting | that at a hundredth of the step |\n|---|---|---|---|\n";
  for (const Column& column : columns()) {
    if (!cells.contains(column.title)) continue;
    const Cell cell = cell_of(cells.at(column.title));
    const std::size_t best = cell.best();
    const Outcome &plain = cell.settings[0], &tuned = cell.settings[best];
    const std::string changed = tuned.changed.empty() ? tuned.setting : tuned.changed;
    text += fmt::format("| {} | {} | {} | {} |\n", column.title, account(plain),
                        best == 0 ? "" : fmt::format("({}) {}", changed, account(tuned)),
                        cell.finer.exists() ? account(cell.finer) : "");
  }
  return text + remarks_on(row);
}

// The number of cases that a column holds: with defaults, with any setting, of all supported cases.
std::string tally(const nlohmann::json& found) {
  std::string text = "| of those it can say: holds with its defaults, with any setting |";
  for (const Column& column : columns()) {
    int said = 0, plain = 0, any = 0;
    for (const Row& row : rows()) {
      if (!found.contains(row.name) || !found.at(row.name).contains(column.title)) continue;
      const Cell cell = cell_of(found.at(row.name).at(column.title));
      said += cell.settings[0].kind != Outcome::cannot_say;
      plain += cell.settings[0].kind == Outcome::survives;
      any += cell.settings[cell.best()].kind == Outcome::survives;
    }
    text += fmt::format(" {}: {}, {} |", said, plain, any);
  }
  return text + "\n";
}

}  // namespace

const std::vector<Column>& columns() {
  static const std::vector<Column> all = {{"Cdot, plane", "Cdot", nullptr, true},
                                          {"Cdot, space", "Cdot", "Cdot in space", false},
                                          {"Box2D", "Box2D", nullptr, true},
                                          {"Chipmunk", "Chipmunk", nullptr, true},
                                          {"Bullet", "Bullet", "Bullet", false},
                                          {"Bullet multibody", "Bullet multibody", "Bullet multibody", false},
                                          {"MuJoCo", "MuJoCo", "MuJoCo", false},
                                          {"ODE", "ODE", "ODE", false},
                                          {"Simbody", "Simbody", "Simbody", false, true}};
  return all;
}

std::vector<Row> rows() {
  std::map<std::string, Row> by_name;
  for (const hard::Case& hard_case : hard::all_cases()) {
    const std::string name = row_of(hard_case);
    Row& row = by_name[name];
    row.name = name;
    row.cases.push_back(hard_case);
  }
  std::vector<Row> all;
  for (const auto& [name, row] : by_name) all.push_back(row);
  return all;
}

Question question(const Row& row, const Column& column) {
  const hard::Case *planar = nullptr, *spatial = nullptr;
  for (const hard::Case& hard_case : row.cases) (is_planar(hard_case) ? planar : spatial) = &hard_case;
  // These cases count turns, which spatial poses do not contain.
  if (row.name == "closed_loops" || row.name == "angle_past_half_a_turn") spatial = nullptr;
  if (row.name.starts_with("long_chains_and_trees, tree")) spatial = nullptr;  // of universal joints, unlike the planar
  if (column.planar) return {planar, engine_of(column.engine)};
  if (spatial != nullptr) return {spatial, engine_of(column.engine)};
  return {planar, engine_of(column.lifted)};
}

std::size_t Cell::best() const {
  if (settings[0].kind == Outcome::survives) return 0;
  return std::size_t(std::min_element(settings.begin(), settings.end()) - settings.begin());
}

nlohmann::json json_of(const Cell& cell) {
  nlohmann::json settings = nlohmann::json::array();
  for (const Outcome& outcome : cell.settings) settings.push_back(json_of(outcome));
  nlohmann::json json{{"settings", settings}};
  if (cell.finer.exists()) json["finer"] = json_of(cell.finer);
  return json;
}

Cell cell_of(const nlohmann::json& json) {
  Cell cell;
  for (const nlohmann::json& outcome : json.at("settings")) cell.settings.push_back(outcome_of(outcome));
  if (json.contains("finer")) cell.finer = outcome_of(json.at("finer"));
  return cell;
}

std::string page(const nlohmann::json& found) {
  std::string text = head, below;
  text += "| case |";
  std::string line = "|---|";
  for (const Column& column : columns()) {
    text += fmt::format(" {} |", column.title);
    line += "---|";
  }
  text += "\n" + line + "\n";
  for (const Row& row : rows()) {
    if (!found.contains(row.name)) continue;
    const nlohmann::json& cells = found.at(row.name);
    text += fmt::format("| {} |", row.name);
    for (const Column& column : columns())
      text += fmt::format(" {} |", cells.contains(column.title) ? brief(cell_of(cells.at(column.title))) : "—");
    text += "\n";
    below += details(row, cells);
  }
  return text + tally(found) + "\n## Case by case\n" + below;
}

}  // namespace cdot::peers
