// The rows of a mechanism as blocks: a kernel with its bodies and parameters in this scene, to be inlined.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "derive/compile/rows/algebra.hpp"
#include "derive/compile/rows/spec_programs.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

using Values = std::map<std::string, int>;  // operations by the names of a kernel's inputs or outputs

// `names` are those of bodies, joints and effects in C++; "" for bodies that do not move.
struct Names {
  std::vector<std::string> bodies, joints, effects, bounded;
};

struct RowBlock {
  std::string name;   // before the names of what it computes
  std::string owner;  // before those of its parameters
  const SpecPrograms* spec = nullptr;
  const RowPrograms* rows = nullptr;
  const std::vector<int>* bodies = nullptr;
  const std::vector<double>* parameters = nullptr;
  const Joint* motor = nullptr;                            // whose speed is the rate of its row
  const std::map<std::size_t, InTime>* in_time = nullptr;  // parameters that follow functions of time; null: none
  const Joint* joint = nullptr;                            // if it is one
  const std::vector<CountedTurns>* turns = nullptr;        // of its parameters; null: none
  int holds = -1;                                          // of a joint that may break, or on one: as Joint::holds
};

// An angle in space with its whole turns.
struct Unwound {
  int angle, turns;
};

// Forces by body and column.
using Forces = std::map<std::pair<int, std::size_t>, Summands>;

constexpr double boundless = 1e30;  // in float, too

// Of a parameter of a kernel, "p.pa_x" or "phi", in the header.
std::string constant_name(const RowBlock& block, const std::string& parameter);
// Of a number of an effect's law.
std::string number_name(const RowBlock& block, const std::string& parameter);

class RowBlocks {
 public:
  RowBlocks(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs);

  const Mechanism& mechanism() const { return mechanism_; }
  const RowBlock& joint(std::size_t j) const { return joints_[j]; }
  const RowBlock& effect(std::size_t e) const { return effects_[e]; }
  const RowBlock& bounded(std::size_t b) const { return bounded_[b]; }
  // Of the joint that may break by it.
  const RowBlock& block_of(const Bond& bond) const;
  // The spec by which a joint breaks.
  const SpecPrograms& bond(const Bond& bond) const { return types_.at(bond_of(bond)); }
  // The spec whose law the effect has.
  const SpecPrograms& law(const Effect& effect) const;
  const std::string& body_name(int index) const { return names_.bodies[static_cast<std::size_t>(index)]; }

  // A number of an effect's law, which may follow a function of time. An infinite one is boundless.
  int number(Algebra& algebra, const Effect& effect, std::size_t k, const std::string& name) const;
  // A function of time: "value", "rate" or "acceleration".
  int in_time(Algebra& algebra, const InTime& function, const std::string& derivative, const std::string& name) const;
  // The speed of a motor, and its derivative.
  int speed(Algebra& algebra, const RowBlock& block) const;
  int speed_rate(Algebra& algebra, const RowBlock& block) const;

  // Inputs of the kernel, in this scene: places and velocities of its bodies, masses, parameters.
  Values inputs(Algebra& algebra, const RowBlock& block) const;
  // A coordinate of a joint, whose whole turns one of its parameters counts.
  Unwound counted(Algebra& algebra, const RowBlock& block, const CountedTurns& turns, const Values& in) const;
  // The same with its J.
  Values inputs_with_jacobian(Algebra& algebra, const RowBlock& block) const;
  // Puts these in place of v in the inputs; by the names of components, "rod.x"; empty: leaves v.
  void replace_velocities(Values& in, const RowBlock& block, const Values& velocities) const;
  // The same of places in the plane: "rod.x", "rod.y", and "rod.w" for its angle.
  void replace_places(Values& in, const RowBlock& block, const Values& places) const;
  // One of its functions. Where the joint broke all is 0, but for a diagonal of 1 of K.
  Values call(Algebra& algebra, const RowBlock& block, const std::string& function, const Values& in) const;
  // M^-1 f of a body in a column, from f by columns.
  int weighted(Algebra& algebra, int body, std::size_t column, const std::function<int(std::size_t column)>& f) const;
  // M a of a body in a column, from a by columns.
  int momentum(Algebra& algebra, int body, std::size_t column, const std::function<int(std::size_t column)>& a) const;
  // An entry of I^-1 in the world's axes; in the plane, of the axis 0.
  int inverse_inertia(Algebra& algebra, int body, std::size_t i, std::size_t j) const;
  // Its I^-1 is that of the body, turned as the body is.
  bool turns_inertia(int index) const { return body(index).moves && body(index).inertia_turns && !is_stiffened_; }
  // x^T I^-1 y, both in its axes.
  double weighed(int body, const std::array<double, 3>& x, const std::array<double, 3>& y) const;
  // "q[rod].xy", of the rotation from its axes to the world's.
  std::string rotation_name(int body, std::size_t i, std::size_t j) const;
  // The same rows on bodies with other inverse inertias, the inputs W.
  RowBlocks stiffened(Constants& constants) const;
  // "W[rod]" or "W[rod].xy"
  std::string stiffened_name(int body, std::size_t i, std::size_t j) const;
  // The rates of the spin of a body whose inertia turns, by its gyroscopic torque: -I^-1 (w x I w), in the world's
  // axes.
  std::array<int, 3> gyroscopic_rates(Algebra& algebra, int body) const;
  // Poses, velocities, time and step of the start, as inputs of programs.
  void note_start(Constants& constants) const;
  // Adds the constant torque of such bodies.
  void add_torques(Algebra& algebra, Forces& forces) const;
  // forces += J^T lambda, with J among `in`.
  void add_forces(Algebra& algebra, const RowBlock& block, Values in, const std::vector<int>& lambda,
                  Forces& forces) const;

 private:
  void add_joint(const Joint& joint, const std::string& name);
  std::string law_of(const Effect& effect) const;
  std::string bond_of(const Bond& bond) const;
  Values call_held(Algebra& algebra, const RowBlock& block, const std::string& function, const Values& in) const;
  static double rounded(const RowBlock& block, std::size_t parameter);
  void note_coordinate_laws(const derive::SpecsFolder& specs);
  // Of rows whose parameters follow functions of time: dC/dt and gamma, from C and J v at this time.
  Values call_in_time(Algebra& algebra, const RowBlock& block, const std::string& function, Values in) const;
  // The joint on whose coordinate an effect of that name acts: they share its parameters. Else `name`.
  std::string owner_of(const std::string& name, const std::string& effect) const;
  // The functions of time that the parameters of that joint follow.
  const std::map<std::size_t, InTime>* functions_of(const std::string& effect) const;
  static void check_time(const RowBlock& block, const std::string& name);
  RowBlock block_of(const std::string& name, const Effect& effect) const;
  static bool move_in_time(const Effect& effect, const RowBlock& block);
  void add_body(Algebra& algebra, Values& in, const std::string& L, int index) const;
  void add_place(Algebra& algebra, Values& in, const std::string& L, int index) const;
  void add_masses(Algebra& algebra, Values& in, const std::string& L, int index) const;
  // f(name of a kernel's input, column) for each column of a body's velocity
  template <class F>
  void each_speed(const std::string& L, F f) const {
    for (std::size_t c = 0; c < mechanism_.columns(); ++c) {
      const std::string column = mechanism_.column(c);
      if (column.front() != 'w') f("v_" + L + "_" + column, c);
      else f("w_" + L + (mechanism_.spatial() ? "_" + column.substr(1) : ""), c);
    }
  }
  const Body& body(int index) const { return mechanism_.bodies[static_cast<std::size_t>(index)]; }
  int inverse_mass(Algebra& algebra, int body) const;
  bool has_whole_tensor(int index) const {
    return body(index).inertia_turns || (is_stiffened_ && mechanism_.spatial());
  }

  const Mechanism& mechanism_;
  const Names& names_;
  std::set<std::string> coordinate_laws_;  // specs on a coordinate of any joint
  std::map<std::string, SpecPrograms> types_;
  std::vector<RowBlock> joints_, effects_, bounded_;
  bool is_stiffened_ = false;
};

}  // namespace cdot::compile
