#include "derive/compile/equations.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <stdexcept>

#include "derive/compile/borne/borne.hpp"
#include "derive/compile/borne/shares.hpp"
#include "derive/compile/foresight/aim.hpp"
#include "derive/compile/midpoint/middle.hpp"
#include "derive/compile/readings/readings.hpp"
#include "derive/compile/rows/bounds.hpp"
#include "derive/compile/rows/dampers.hpp"
#include "derive/compile/rows/joint_rows.hpp"
#include "derive/compile/rows/kick.hpp"
#include "derive/compile/rows/motion.hpp"
#include "derive/compile/scene/groups.hpp"
#include "derive/kernel/factor.hpp"
#include "derive/program/print.hpp"
#include "runtime/text/spelling.hpp"

namespace cdot::compile {
namespace {

using derive::element;

class EquationWriter {
 public:
  EquationWriter(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs)
      : mechanism_(mechanism), blocks_(mechanism, names, specs), joints_(blocks_) {
    out_.rows = system().names();
  }

  Equations write() {
    out_.constants.inputs = {mechanism_.inputs.begin(), mechanism_.inputs.end()};
    blocks_.note_start(out_.constants);
    if (system().size() > 0) {
      out_.evaluate = joints_.evaluate(out_.constants, out_.stored);
      write_errors();
      write_rates();
      write_solve();
    }
    const bool accelerates = mechanism_.on_accelerations(), modes = accelerates && !mechanism_.bounded.empty();
    if (accelerates && (system().size() > 0 || modes))
      out_.accelerate = accelerations_of(blocks_, joints_, out_.constants);
    if (modes || mechanism_.method == Method::rattle || (accelerates && system().size() == 0))
      out_.fall = fall_of(blocks_, out_.constants);
    if (mechanism_.method == Method::euler && (!mechanism_.effects.empty() || !mechanism_.bounded.empty()))
      out_.kick = kick_of(blocks_, joints_, out_.constants);
    if (!mechanism_.effects.empty() || !mechanism_.bounded.empty())
      out_.potential = potential_of(blocks_, out_.constants);
    if (mechanism_.method == Method::rattle || mechanism_.method == Method::implicit) write_finish();
    if (mechanism_.method == Method::implicit) write_middle();
    if (mechanism_.angles > 0) out_.angles = angles_of(blocks_, out_.constants);
    write_bounded();
    if (!mechanism_.bonds.empty()) write_bonds();
    if (mechanism_.method == Method::rattle && (out_.exerts || !mechanism_.bounded.empty())) list_groups();
    // Ends that a guess passes are other ones than those that the step passes. By RATTLE forces that change with rates
    // pull beside the joints. Rows of velocities have no error by which a wrong guess is taken back.
    if (system().size() > 0 && foresees()) {
      if (mechanism_.method == Method::euler && mechanism_.effects.empty() && mechanism_.bounded.empty())
        out_.freedom = freedom_of(blocks_, joints_, out_.constants);
      if (!out_.freedom.exists()) write_foreseen();
    }
    drop_unread();
    out_.coordinates = read_coordinates(blocks_, out_.constants);
    if (system().size() > 0) out_.reactions = read_reactions(blocks_, joints_, out_.constants);
    out_.apart = stages_read_no_centre();
    check_inputs();
    return std::move(out_);
  }

 private:
  const RowSystem& system() const { return joints_.system(); }

  void write_errors() {
    Algebra algebra(out_.constants);
    const std::vector<int> errors = joints_.errors(algebra);
    for (std::size_t row = 0; row < errors.size(); ++row) algebra.output(element("C", row), errors[row]);
    out_.errors = algebra.finish_as_kernels();
  }

  void write_rates() {
    Algebra algebra(out_.constants);
    const std::vector<int> rates = joints_.rates(algebra, {});
    for (std::size_t row = 0; row < rates.size(); ++row) algebra.output(element("Cdot", row), rates[row]);
    out_.rates = algebra.finish();
  }

  void write_solve() {
    Algebra algebra(out_.constants);
    std::vector<int> b;
    for (std::size_t row = 0; row < system().size(); ++row) b.push_back(algebra.input(element("b", row)));
    const std::vector<int> lambda =
        system().solve(algebra, b, [&](const std::string& name) { return joints_.factor(algebra, name); });
    const std::vector<std::size_t>& order = system().order();
    for (auto row = order.rbegin(); row != order.rend(); ++row) algebra.output(element("lambda", *row), lambda[*row]);
    system().write_changes(algebra, lambda, [&](std::size_t k) { return joints_.inputs(algebra, k); });
    out_.solve = algebra.finish();
  }

  void write_finish() {
    const Dampers dampers(blocks_, out_.constants);
    out_.finishes = !dampers.empty() || !mechanism_.bounded.empty();
    if (!dampers.empty()) out_.dampen = dampers.dampen();
    out_.effect_of = dampers.effect_of(), out_.triangle = dampers.triangle();
    if (!out_.effect_of.empty()) out_.notice = dampers.notice(), out_.look = dampers.look();
    if (mechanism_.has_bonds_on_effects()) {
      const Borne borne(blocks_);
      out_.bear_start = borne.at_start(out_.constants, dampers);
      if (!dampers.empty() || mechanism_.method == Method::rattle)
        out_.bear_end = borne.at_end(out_.constants, dampers);
    }
    if (out_.finishes) out_.finish = dampers.finish(joints_);
    for (std::size_t b = 0; b < mechanism_.bounded.size() && mechanism_.method == Method::rattle; ++b)
      out_.exerts |= prescribes_rate(blocks_, b), out_.has_clutches |= drives_one_way(blocks_, b, out_.constants);
    out_.exerts |= mechanism_.method == Method::rattle && mechanism_.has_rates();
    if (out_.exerts) out_.exert = exert_of(blocks_, joints_, out_.constants);
    if (mechanism_.method == Method::rattle) list_freed();
  }

  void list_freed() {
    for (std::size_t k = 0; k < system().blocks().size(); ++k) {
      const RowBlock& block = system().blocks()[k];
      for (std::size_t r = 0; r < block.rows->count(); ++r)
        if (block.joint->is_rate[r]) out_.freed.push_back(static_cast<int>(system().first_row(k) + r));
    }
  }

  bool foresees() const {
    const Method method = mechanism_.method;
    return mechanism_.foresees && !mechanism_.open && mechanism_.bonds.empty() && !mechanism_.has_loads() &&
           !mechanism_.has_rates() && (method == Method::euler || method == Method::rattle) && !out_.has_ends &&
           !out_.finishes && !out_.exerts;
  }

  void write_middle() {
    const Middle middle(blocks_, joints_, out_.constants);
    if (!mechanism_.effects.empty()) out_.weigh = middle.weigh();
    if (system().size() > 0 || !mechanism_.bounded.empty()) out_.stiffen = middle.stiffen();
    out_.improve = middle.improve();
    out_.taut = middle.tensions().rows(), out_.taut_numbers = middle.tensions().numbers();
    if (mechanism_.has_bonds_on_effects()) out_.bear = middle.bear(Borne(blocks_));
  }

  void write_foreseen() {
    Aim aim(blocks_, joints_);
    out_.aim = aim.factor(out_.constants, out_.aimed);
    out_.solve_aimed = aim.solve(out_.constants);
    Algebra algebra(out_.constants);
    std::vector<int> lambda;
    for (std::size_t row = 0; row < system().size(); ++row) lambda.push_back(algebra.input(element("lambda", row)));
    system().write_changes(algebra, lambda, [&](std::size_t k) { return joints_.inputs(algebra, k); });
    out_.apply = algebra.finish();
  }

  void list_groups() {
    const std::vector<int> all = groups_of(mechanism_);
    std::vector<int> of_body, of_row;
    std::ranges::copy_if(all, std::back_inserter(of_body), [](int group) { return group >= 0; });
    for (const RowBlock& block : system().blocks())
      of_row.insert(of_row.end(), block.rows->count(), group_of(all, *block.bodies));
    out_.groups = 1 + *std::ranges::max_element(of_body);
    out_.group_lists = fmt::format("  static constexpr int groups = {};  // mechanisms\n", out_.groups);
    const auto list = [&](const char* name, const std::vector<int>& groups) {
      if (!groups.empty())
        out_.group_lists +=
            fmt::format("  static constexpr int group_of_{}[] = {{{}}};\n", name, fmt::join(groups, ", "));
    };
    list("body", of_body), list("row", of_row), list("bound", groups_of_bounds(mechanism_));
  }

  void write_bonds() {
    out_.strain = strain_of(blocks_, out_.constants);
    if (system().size() > 0 && system().has_redundant_rows()) write_share();
    const Borne borne(blocks_);
    out_.first_borne = borne.first();
    if (mechanism_.method == Method::euler && borne.size() > 0) out_.bear = borne.in_kick(out_.constants);
    if (mechanism_.on_accelerations() && borne.size() > 0) out_.bear = borne.at_rates(out_.constants);
    if (mechanism_.method == Method::rattle)
      out_.draw =
          displace_of(blocks_, joints_, out_.constants, [&](std::size_t b) { return prescribes_rate(blocks_, b); });
    std::size_t row = 0;
    for (std::size_t j = 0; j < mechanism_.joints.size(); row += blocks_.joint(j++).rows->count())
      out_.first_rows.push_back(row);
    out_.first_rows.push_back(row);
  }

  bool stages_read_no_centre() const {
    const bool is_explicit = mechanism_.method == Method::rk4 || mechanism_.method == Method::dop853;
    if (!is_explicit || !mechanism_.bounded.empty()) return false;
    std::set<std::string> read;
    for (const Program* program : {&out_.evaluate, &out_.accelerate, &out_.fall})
      read.merge(derive::inputs_read(*program, {}));
    return std::ranges::none_of(read, [](const std::string& input) {
      const bool of_body = input.starts_with("q[") || input.starts_with("v[");
      return of_body && (input.ends_with("].x") || input.ends_with("].y") || input.ends_with("].z"));
    });
  }

  void write_share() {
    if (mechanism_.has_loads())
      throw std::runtime_error(
          fmt::format("{}: cdot compile knows no joints that break beside redundant ones, whose loads are to be "
                      "shared, and friction by a load. Fix: leave it to cdot-run",
                      mechanism_.bonds.front().name));
    out_.share = share_of(joints_, out_.constants);
  }

  void check_inputs() const {
    const std::vector<std::string> known(out_.constants.known.begin(), out_.constants.known.end());
    for (const std::string& input : out_.constants.inputs) {
      if (out_.constants.inputs_read.contains(input)) continue;
      const std::string like = text::nearest(input, known, 4);
      std::string list;
      for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
      throw std::runtime_error(fmt::format("no number of this scene is called {}{}. Its numbers are: {}", input,
                                           like.empty() ? "" : fmt::format(" (did you mean {}?)", like), list));
    }
  }

  void write_bounded() {
    for (std::size_t b = 0; b < mechanism_.bounded.size(); ++b) {
      out_.is_rate += std::string(b == 0 ? "" : ", ") + (prescribes_rate(blocks_, b) ? "true" : "false");
      out_.waits += std::string(b == 0 ? "" : ", ") + (waits(blocks_, b) ? "true" : "false");
      out_.cones += fmt::format("{}{}", b == 0 ? "" : ", ", mechanism_.bounded[b].cone);
      out_.has_ends |= has_ends(blocks_, b), out_.has_events |= has_events(blocks_, b);
      const bool late = is_late_end(blocks_, b, out_.constants);
      out_.has_late_ends |= late, out_.late += std::string(b == 0 ? "" : ", ") + (late ? "true" : "false");
    }
    if (out_.has_events) out_.distances = distances_of(blocks_, out_.constants);
    if (mechanism_.on_accelerations() && !mechanism_.bounded.empty()) {
      out_.has_ends = true;  // held rows, whose ends and rates a projection keeps
      out_.guard = guard_of(blocks_, out_.constants), out_.resolve = resolve_of(blocks_, out_.constants);
    }
    if (mechanism_.has_loads()) out_.carry = carry_of(blocks_, joints_, out_.constants);
    const bool starts_motors =
        mechanism_.method == Method::rattle && mechanism_.has_loads() && mechanism_.has_strong_motors();
    if (out_.has_ends || starts_motors) out_.along = along_of(blocks_, out_.constants);
    if (!out_.has_ends) return;
    out_.reach = reach_of(blocks_, joints_, out_.constants);
    out_.past = past_of(blocks_, out_.constants);
    if (mechanism_.method == Method::rattle || mechanism_.method == Method::implicit)
      out_.nearest = nearest_of(blocks_, out_.constants);
    if (mechanism_.method == Method::implicit) out_.drift_of_ends = drift_of_ends(blocks_, out_.constants);
    if (mechanism_.keeps_momenta())
      out_.displace =
          displace_of(blocks_, joints_, out_.constants, [&](std::size_t b) { return has_ends(blocks_, b); });
  }

  // Numbers that nobody reads are not stored, and c and s of no body that nobody reads.
  void drop_unread() {
    std::set<std::string> read;
    for (const Program* program : programs_of_equations(out_)) read.merge(derive::inputs_read(*program, {}));
    const auto unread = [&](const std::string& member) { return !read.contains("J." + member); };
    std::erase_if(out_.stored, unread);
    std::erase_if(out_.evaluate.outputs, [&](const derive::Output& o) { return !read.contains(o.name); });
    for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b) {
      const std::string& name = blocks_.body_name(b);
      if (read.contains("q[" + name + "].c") || read.contains("q[" + name + "].s")) out_.turning.insert(name);
    }
  }

  const Mechanism& mechanism_;
  RowBlocks blocks_;
  JointRows joints_;
  Equations out_;
};

}  // namespace

std::vector<const Program*> programs_of_equations(const Equations& e) {
  std::vector<const Program*> programs = programs_of_freedom(e.freedom);
  programs.insert(programs.end(), {&e.evaluate, &e.errors,        &e.rates,     &e.accelerate, &e.solve,     &e.apply,
                                   &e.aim,      &e.solve_aimed,   &e.fall,      &e.kick,       &e.potential, &e.reach,
                                   &e.past,     &e.along,         &e.angles,    &e.dampen,     &e.notice,    &e.look,
                                   &e.finish,   &e.exert,         &e.distances, &e.guard,      &e.resolve,   &e.carry,
                                   &e.weigh,    &e.stiffen,       &e.improve,   &e.displace,   &e.nearest,   &e.strain,
                                   &e.draw,     &e.drift_of_ends, &e.bear,      &e.bear_start, &e.bear_end,  &e.share});
  return programs;
}

std::set<std::string> functions_of(const Program& program) {
  std::set<std::string> functions;
  const std::vector<int> uses = derive::use_counts(program);
  for (std::size_t k = 0; k < program.ops.size(); ++k)
    if (const Operation& op = program.ops[k];
        uses[k] > 0 && op.kind == OpKind::function && !derive::function_of(op.fn).of_contract)
      functions.insert(std::string(derive::function_of(op.fn).name));
  return functions;
}

std::set<std::string> functions_of(const Equations& equations) {
  std::set<std::string> functions;
  for (const Program* program : programs_of_equations(equations)) functions.merge(functions_of(*program));
  for (const Program* program : {&equations.coordinates, &equations.reactions}) functions.merge(functions_of(*program));
  return functions;
}

Equations equations_of(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs) {
  return EquationWriter(mechanism, names, specs).write();
}

}  // namespace cdot::compile
