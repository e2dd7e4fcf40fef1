#include "derive/compile/header.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

#include "derive/compile/arithmetic.hpp"
#include "derive/compile/bodies.hpp"
#include "derive/compile/bounded/active_set.hpp"
#include "derive/compile/equations.hpp"
#include "derive/compile/foresight/foresight.hpp"
#include "derive/compile/gyroscopes.hpp"
#include "derive/compile/identifiers.hpp"
#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/methods/events.hpp"
#include "derive/compile/methods/loads.hpp"
#include "derive/compile/methods/modes.hpp"
#include "derive/compile/methods/rates.hpp"
#include "derive/compile/methods/state.hpp"
#include "derive/compile/methods/tables.hpp"
#include "derive/compile/midpoint/implicit.hpp"
#include "derive/compile/midpoint/tension.hpp"
#include "derive/compile/one_freedom/step.hpp"
#include "derive/compile/rattle/rattle.hpp"
#include "derive/compile/rattle/start.hpp"
#include "derive/compile/readings/readings.hpp"
#include "derive/compile/steps.hpp"
#include "derive/compile/texts.hpp"
#include "derive/compile/types.hpp"
#include "derive/program/print.hpp"

namespace cdot::compile {
namespace {

class HeaderWriter {
 public:
  HeaderWriter(const Mechanism& mechanism, const Request& request, const derive::SpecsFolder& specs)
      : mechanism_(mechanism), request_(request), used_(taken_names()) {
    name_ = request.struct_name.empty() ? std::filesystem::path(mechanism.file).stem().string() : request.struct_name;
    name_ = unused(identifier(name_), used_);
    for (const Body& body : mechanism.bodies) names_.bodies.push_back(unused(identifier(body.name), used_));
    std::set<std::string> joints = used_;
    for (const Joint& joint : mechanism.joints) names_.joints.push_back(unused(identifier(joint.name), joints));
    for (const Effect& effect : mechanism.effects) names_.effects.push_back(unused(identifier(effect.name), joints));
    for (const Effect& effect : mechanism.bounded) names_.bounded.push_back(unused(identifier(effect.name), joints));
    equations_ = equations_of(mechanism, names_, specs);
    name_readings();
  }

  Header write() {
    write_head();
    write_types();
    write_start();
    const BodyTexts bodies{mechanism_, names_.bodies};
    text_ += bodies.turn(equations_.turning) + gyroscopes_of(mechanism_, names_.bodies);
    if (has().midpoint && has().gyroscopes) text_ += mean_spins_of(mechanism_, names_.bodies);
    if (mechanism_.method == Method::euler && !has_effects()) text_ += bodies.push();
    text_ += bodies.weighed(has().foresees && has().gyroscopes) + bodies.energy(has_effects()) +
             (has().midpoint && has().drags ? bodies.dragged() : "");
    write_equations();
    write_corrections();
    if (has().exerts) text_ += start_of(has());
    write_step();
    text_ += "};\n\n}  // namespace cdot::scenes\n";
    const auto [bodies_moving, rates, centres] = slope_size(mechanism_, has().apart);
    return {unrolled(with_arguments(std::move(text_)),
                     {bodies_moving, equations_.rows.size(), rates, centres, equations_.freedom.angles.size()}),
            name_, operations_of(equations_, calls_of(mechanism_.method, has())),
            state_bytes_of(mechanism_, equations_, has())};
  }

 private:
  Contents has() const { return contents_of(mechanism_, equations_); }
  bool has_effects() const { return has().effects || has().bounded; }
  bool has_inputs() const { return !equations_.constants.inputs.empty(); }
  std::string with_arguments(std::string text) const {
    return compile::with_arguments(std::move(text), {has_inputs(), has().angles, has().events, has().bonds,
                                                     has().gyroscopes, pose_argument(mechanism_)});
  }
  void line(const std::string& line = {}) { text_ += line + "\n"; }

  // After all constants and joints of the scene.
  void name_readings() {
    std::set<std::string> taken = used_;
    for (const auto& [constant, value] : equations_.constants.named) taken.insert(constant);
    taken.insert(names_.joints.begin(), names_.joints.end());
    for (const std::string& name : coordinates_of(mechanism_)) coordinates_.push_back(unused(identifier(name), taken));
    for (const auto* names : {&coordinates_, &names_.joints}) used_.insert(names->begin(), names->end());
  }

  void write_head() {
    std::set<std::string> calls = functions_of(equations_);
    const auto own = std::erase_if(calls, [](const std::string& f) { return own_function(f) != nullptr; });
    const bool others = !calls.empty() || has().bonds || has().cones || (has().midpoint && has().drags);
    text_ += head_of(mechanism_, request_.command, others || mechanism_.spatial());
    if (own > 0) text_ += functions;
    if (mechanism_.spatial() && has().midpoint) text_ += tension;
    line("namespace cdot::scenes {");
    line();
    line("template <class T>");
    line("struct " + name_ + " {");
  }

  void write_enum(const std::string& type, const std::vector<std::string>& names, const std::string& count) {
    if (names.empty()) return;
    const std::string text = fmt::format("  enum {} {{ {}, {} }};", type, fmt::join(names, ", "), count);
    for (const std::string& wrapped : derive::wrapped(text)) line(wrapped);
  }

  void write_types() {
    std::vector<std::string> bodies;
    for (std::size_t i = 0; i < mechanism_.bodies.size(); ++i)
      if (mechanism_.bodies[i].moves) bodies.push_back(names_.bodies[i]);
    write_enum("Body", bodies, "bodies");
    line(fmt::format("  static constexpr int rows = {};", equations_.rows.size()));
    write_enum("Bound", names_.bounded, "bounded");
    write_enum("Reaction", joints_of(mechanism_, names_), "reactions");
    write_enum("Coordinate", coordinates_, "coordinates");
    if (has().exerts || (has().events && has().pulls())) text_ += equations_.group_lists;
    line(fmt::format("  static constexpr double default_step = {};  // [s]", mechanism_.step));
    for (const auto& [name, value] : equations_.constants.named)
      line(fmt::format("  static constexpr double {} = {};", name, value));
    text_ += types_of(mechanism_, name_, has().apart);
    text_ += number_types_of(mechanism_, equations_, has());
    text_ += state_of(mechanism_, has(), has_inputs());
  }

  void write_start() {
    line("\n  // The start of the scene.");
    line("  static void reset(State& s) {");
    line("    s.time = T(0);");
    text_ += BodyTexts{mechanism_, names_.bodies}.start();
    for (const auto& [name, value] : equations_.constants.inputs_read)
      line(fmt::format("    s.p.{} = T({});", name, value));
    text_ += reset_of(has()) + "    begin(s);\n  }\n" + begin_of(mechanism_.method, has());
  }

  void write_function(const std::string& comment, const std::string& head, const Program& program) {
    line();
    line("  // " + comment + ": " + derive::text(derive::count(program)));
    const std::string arguments = with_arguments(head);
    const bool is_of_steps = head.starts_with("solve(") || head.find("Freedom& F") != std::string::npos;
    const bool inlined = is_of_steps && derive::count(program).total() <= few_operations;
    const std::string kind = inlined ? "  CDOT_SCENE_INLINE static void " : "  static void ";
    for (const std::string& wrapped : derive::wrapped(kind + arguments + " {")) line(wrapped);
    derive::Printing printing;
    printing.indent = "    ";
    printing.reserved = used_;
    for (const auto& [constant, value] : equations_.constants.named) printing.reserved.insert(constant);
    write_using(program);
    const std::vector<std::string> lines = derive::print_statements(program, printing);
    for (const std::string& statement : lines) line(statement);
    const bool declares = head.find("$d") != std::string::npos;
    if (declares && has_inputs()) line("    (void)p;");
    if (declares && has().angles) line("    (void)angles;");
    if (declares && has().events) line("    (void)events;");
    if (declares && has().bonds) line("    (void)bonds;");
    for (const std::string argument :
         {"q",     "v",   "a",      "time", "J", "B",  "b",    "h",      "lambda", "force", "C", "rate", "K", "guess",
          "given", "end", "before", "W",    "g", "mu", "mean", "missed", "side",   "load",  "F", "free", "d", "found"})
      if (reads(arguments, argument)) line(fmt::format("    (void){};", argument));
    const bool writes = std::ranges::any_of(program.outputs, [](const auto& o) { return o.name.starts_with("W["); });
    if (!writes && arguments.find("(&W)") != std::string::npos) line("    (void)W;");
    line("  }");
  }

  void write_using(const Program& program) {
    for (const std::string& f : functions_of(program))
      line(own_function(f) ? fmt::format("    constexpr {} {};", own_function(f), f) : "    using std::" + f + ";");
  }

  void write_equations() {
    const std::string at = "$dconst Pose (&q)[bodies], const T& time", moving = "const Velocity (&v)[bodies]";
    text_ += guards + tables_of(mechanism_);
    if (has().modes) text_ += "  static constexpr double slight = single ? 1e-4 : 1e-9;  // a relative resolution\n";
    text_ += bounded_of(equations_.is_rate, has());
    if (has().looks)
      text_ += damping_of(equations_.effect_of.size(), equations_.effect_of.back() + 1, equations_.triangle);
    if (has().rows) {
      write_function("J, and the factor of K", "evaluate(" + at + ", Jacobian& J)", equations_.evaluate);
      write_function("C", "errors(" + at + ", T (&C)[rows])", equations_.errors);
      write_function("J v + dC/dt", "rates(const Jacobian& J, " + moving + ", T (&Cdot)[rows])", equations_.rates);
      write_function("K lambda = b, d = M^-1 J^T lambda",
                     "solve($gconst Jacobian& J, const T (&b)[rows], T (&lambda)[rows], Velocity (&d)[bodies])",
                     equations_.solve);
    }
    for (const auto& functions : {functions_of_foresight(equations_.apply, equations_.aim, equations_.solve_aimed),
                                  functions_of_freedom(equations_.freedom)})
      for (const auto& [comment, head, program] : functions) write_function(comment, head, *program);
    if (has_effects())
      write_function("Potential energy of the effects", "potential(" + at + ", T& E)", equations_.potential);
    if (has().rattle) write_rattle(at, moving);
    else if (has().midpoint) write_midpoint(at, moving);
    else if (mechanism_.on_accelerations()) write_accelerations(at, moving);
    else if (has_effects())
      write_function("Velocities after h with the effects, implicit as far as their slopes say",
                     "kick(" + at + ", " + moving + (has().rows ? ", const Jacobian& J" : "") +
                         ", const T& h, Velocity (&next)[bodies]" + (has().rows ? ", T (&lambda)[rows]" : "") +
                         (has().bounded ? ", Bounded& B)" : ")"),
                     equations_.kick);
    if (has().bears) write_bear(at, moving);
    if (has().corrects_loads()) write_carry(at), text_ += settle_loads_of(has(), equations_.cones);
    if (has().ends) write_ends(at);
    if (!equations_.along.outputs.empty())
      write_function("J v of rows with bounds", "along(" + at + ", " + moving + ", T (&along)[bounded])",
                     equations_.along);
    if (has().events) {
      write_function("Distances from the events of rows with bounds",
                     "distances(" + at + ", " + moving + (has().forces ? ", const T (&force)[bounded]" : "") +
                         ", T (&after)[bounded], T (&until)[bounded])",
                     equations_.distances);
      text_ += latch_of(equations_.waits, has()) + approach_of(mechanism_, equations_.late, has());
    }
    if (has().bonds) {
      write_function("How far joints are from breaking", "strain(" + arguments_of_strain(mechanism_),
                     equations_.strain);
      if (has().pulls()) write_function(draws, "draw(" + at + arguments_of_draw(has()), equations_.draw);
      if (has().shares)
        write_function("Loads shared among redundant rows",
                       "share(const Jacobian& J, const T (&lambda)[rows], T (&shared)[rows])", equations_.share);
      text_ += snap_of(mechanism_, {equations_.first_rows, equations_.first_borne}, has());
    }
    write_readings(at, moving);
    if (has().angles)
      write_function("Angles with their whole turns",
                     fmt::format("count({}, T (&angle)[{}], T (&turns)[{}])", at, mechanism_.angles, mechanism_.angles),
                     equations_.angles);
  }

  void write_readings(const std::string& at, const std::string& moving) {
    const std::string values = "T (&value)[coordinates], T (&rate)[coordinates])",
                      loads = "Velocity (&load)[reactions])";
    const auto of_state = [&](const std::string& name, const std::string& results, const std::string& call) {
      line("  static void " + name + "(const State& s, " + results + " {");
      line(with_arguments("    " + name + "(" + call + ");\n  }"));
    };
    if (!coordinates_.empty()) {
      const char* const angles = mechanism_.spatial() ? ", angles within half a turn" : "";
      write_function(fmt::format("Coordinates that joints leave free{}, and their rates", angles),
                     "coordinates_of(" + at + ", " + moving + ", " + values, equations_.coordinates);
      of_state("coordinates_of", values, "$ss.q, s.time, s.v, value, rate");
    }
    if (!has().rows) return;
    write_function("J^T lambda of each joint on its last body, torques about its centre of mass",
                   "reactions_of(" + at + ", const T (&lambda)[rows], " + loads, equations_.reactions);
    of_state("reactions_of", loads, "$ss.q, s.time, s.lambda, load");
  }

  void write_bear(const std::string& at, const std::string& moving) {
    const auto write = [&](const char* comment, const std::string& name, const std::string& more, const Program& of) {
      if (!of.outputs.empty())
        write_function(comment, name + "(" + at + ", " + moving + more + ", T (&borne)[borne_rows])", of);
    };
    write("Forces of effects that may break", "bear", arguments_of_bear(mechanism_.method), equations_.bear);
    write("What they do at the start of a step of h", "bear_start", ", const T& h", equations_.bear_start);
    write("What they do at its end", "bear_end", arguments_of_bear_end(has()), equations_.bear_end);
  }

  // At both ends of a step.
  void write_dampers(const std::string& at, const std::string& moving, const std::string& end) {
    const std::string J = has().rows ? ", const Jacobian& J" : "", lambda = has().rows ? ", T (&lambda)[rows]" : "";
    if (has().dampens)
      write_function("Velocities after the effects at the start of a step of h that change with their rates",
                     "dampen(" + at + ", " + moving + ", const T& h, Velocity (&next)[bodies])", equations_.dampen);
    if (has().looks) {
      write_function("C, rates and K of such effects",
                     "notice(" + at + ", " + moving + ", T (&C)[damped], T (&rate)[damped], T (&K)[triangles])",
                     equations_.notice);
      write_function(
          "Such effects alone, at guessed rates: a step of Newton's method, impulses given - end rate, and errors",
          "look($dconst T (&C)[damped], const T (&rate)[damped], const T (&K)[triangles], const T (&guess)[damped], "
          "const T& time, const T& h, T (&step)[damped], "
          "T (&given)[damped], T (&end)[damped], T (&miss)[dampers], T (&size)[dampers])",
          equations_.look);
      text_ += find_rates_of(equations_.effect_of);
    }
    if (has().finishes)
      write_function("The end of a step of h: J v = -dC/dt, with the effects",
                     "finish(" + at + ", " + moving + J + ", const T& h" +
                         (has().looks ? ", const T (&given)[damped], const T (&end)[damped]" : "") +
                         ", Velocity (&next)[bodies]" + lambda + end,
                     equations_.finish);
  }

  void write_rattle(const std::string& at, const std::string& moving) {
    text_ += pushes_of(has()) + frees_of(equations_.freed);
    const std::string J = has().rows ? ", const Jacobian& J" : "", lambda = has().rows ? ", T (&lambda)[rows]" : "";
    const std::string end = ", Velocity (&pull)[bodies]" + std::string(has().bounded ? ", Bounded& B)" : ")");
    write_function("Accelerations without joints", "fall(" + at + ", " + moving + ", Velocity (&a)[bodies])",
                   equations_.fall);
    write_dampers(at, moving, end);
    if (has().exerts)
      write_function("Forces at the start of a run, with motors that reach their rates in h/2",
                     "exert(" + at + ", " + moving + J + ", const T& h" + lambda + end, equations_.exert);
  }

  void write_midpoint(const std::string& at, const std::string& moving) {
    write_dampers(at, moving, has().bounded ? ", Bounded& B)" : ")");
    if (has().effects) {
      line(fmt::format("\n  static constexpr int effect_rows = {};", equations_.weigh.outputs.size()));
      write_function("K of the rows of effects", "weigh_effects(" + at + ", T (&K)[effect_rows])", equations_.weigh);
    }
    if (has().stiffens())
      write_function(
          has().spatial ? "Stiffness of tension" : "Inverse inertias with the stiffness of tension in a step of h",
          (has().spatial ? "tension(" + at : "stiffen(" + at + ", const T& h") + ", " + impulses_of(has()) +
              "Inertia (&W)[bodies]" + (has().taut ? ", Taut& B)" : ")"),
          equations_.stiffen);
    if (has().stiffens() && has().spatial) text_ += stiffen_of(mechanism_, names_.bodies, has());
    write_function("A round of Newton in the middle of a step of h: changes d of v, and y of lambda / 2",
                   "improve(" + at + ", " + moving + arguments_of_improve(has()), equations_.improve);
    text_ += BodyTexts{mechanism_, names_.bodies}.judged();
  }

  void write_ends(const std::string& at) {
    write_function("The part of rows with ends in a projection",
                   "reach(" + at + (has().rows ? ", const Jacobian& J" : "") + ", Bounded& B)", equations_.reach);
    write_function("Errors of rows with ends", "past(" + at + ", T (&past)[bounded])", equations_.past);
    if (has().rattle || has().midpoint)
      write_function("C - end of the nearer end, and its side: 1 for the lower one, -1 for the upper one, 0 for both",
                     "nearest(" + at + ", T (&off)[bounded], T (&side)[bounded])", equations_.nearest);
    if (has().ends_drift)
      write_function("Rates of C from the nearer end of bodies at rest",
                     "drift_of_ends(" + at + ", T (&moves)[bounded])", equations_.drift_of_ends);
    if (mechanism_.keeps_momenta())
      write_function("d = M^-1 (J^T lambda + E^T mu), E the rows with bounds",
                     "displace(" + at + (has().rows ? ", const Jacobian& J, const T (&lambda)[rows]" : "") +
                         ", const T (&mu)[bounded], Velocity (&d)[bodies])",
                     equations_.displace);
  }

  void write_accelerations(const std::string& at, const std::string& moving) {
    if (!has().rows || has().modes)
      write_function("Accelerations without joints", "fall(" + at + ", " + moving + ", Velocity (&a)[bodies])",
                     equations_.fall);
    if (!has().rows && !has().modes) {
      text_ += free_slope;
      return;
    }
    write_function("M a = f + J^T lambda with J a = gamma = -Jdot v - d/dt(dC/dt)",
                   "accelerate(" + at + ", " + moving + (has().rows ? ", const Jacobian& J, T (&lambda)[rows]" : "") +
                       ", Velocity (&a)[bodies]" + (has().modes ? ", Bounded& B)" : ")"),
                   equations_.accelerate);
    if (has().modes) write_modes(at, moving);
    else text_ += slope;
  }

  void write_carry(const std::string& at) {
    write_function("The forces with which bounds grow", "carry(" + at + arguments_of_carry(has()), equations_.carry);
  }

  void write_modes(const std::string& at, const std::string& moving) {
    write_function("Ends, rates and bounds of rows with bounds", "guard(" + at + ", " + moving + ", Guards& B)",
                   equations_.guard);
    write_function(
        "Their resolutions, in units of the relative one",
        "resolve(" + at + ", " + moving +
            ", const Velocity (&a)[bodies], const T (&force)[bounded], const T& h, T (&of_value)[bounded], T "
            "(&of_rate)[bounded], T (&of_force)[bounded], T (&of_hop)[bounded])",
        equations_.resolve);
    if (has().loads) write_carry(at);
    text_ += modes_of(has(), equations_.waits, equations_.cones, equations_.late, mechanism_.tolerance);
  }

  void write_step() {
    std::string step = step_of(mechanism_, has());
    if (breaks(mechanism_) || has().replaces()) text_ += replaces;
    if (breaks(mechanism_)) {
      step.replace(step.find(step_head), step_head.size(), "advance(State& s, const T& h)");
      step += step_in_parts(mechanism_.method, has());
    }
    if (has().one_freedom) step = by_rows(step) + step_of_freedom(equations_.freedom, mechanism_.tolerance);
    text_ += step;
  }

  void write_corrections() {
    const char* const renew =
        mechanism_.on_accelerations() ? "        weigh(s.q, renews);\n" : "        follow(s, renews);\n";
    text_ += corrections_of(mechanism_.tolerance, has(), has().gyroscopes ? renew : "");
  }

  const Mechanism& mechanism_;
  const Request& request_;
  std::set<std::string> used_;
  std::string name_;
  Names names_;
  Equations equations_;
  std::vector<std::string> coordinates_;  // in C++
  std::string text_;
};

}  // namespace

Header header_of(const Mechanism& mechanism, const Request& request, const derive::SpecsFolder& specs) {
  return HeaderWriter(mechanism, request, specs).write();
}

}  // namespace cdot::compile
