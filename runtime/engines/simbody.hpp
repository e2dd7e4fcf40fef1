// A joint as a constraint of Simbody: a Constraint::Custom, exact to the accuracy of the integrator that runs it.
//
// C, Cdot and the accelerations follow from the kernel, so Simbody's multipliers, projections and accuracy hold as for
// its own constraints. Points and directions of `parameters` are those of the bodies' frames. Ground is a body like
// others. Motors, limits and springs are Simbody's own forces; a row C >= 0 has no counterpart. Whole turns of an angle
// that a row reads are counted from step to step in the State.
#pragma once

#include <Simbody.h>

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"

namespace cdot::simbody {

template <class Block>
constexpr int rows_of(RowKind kind) {
  int count = 0;
  for (const RowKind k : Block::row_kinds) count += k == kind ? 1 : 0;
  return count;
}

inline spatial::Pose<double> pose_of(const SimTK::Transform& X) {
  const SimTK::Rotation& R = X.R();
  const SimTK::Quaternion e = R.convertRotationToQuaternion();
  return {X.p()[0], X.p()[1], X.p()[2], e[0],    e[1],    e[2],    e[3],    R[0][0],
          R[0][1],  R[0][2],  R[1][0],  R[1][1], R[1][2], R[2][0], R[2][1], R[2][2]};
}
// Of velocities and of accelerations: Simbody's have the angular part first.
inline spatial::Velocity<double> velocity_of(const SimTK::SpatialVec& V) {
  return {V[1][0], V[1][1], V[1][2], V[0][0], V[0][1], V[0][2]};
}

template <class Block, class... Coordinates>
class Equations final : public SimTK::Constraint::Custom::Implementation {
  static constexpr int n = Block::rows, count = Block::bodies;
  static_assert(rows_of<Block>(RowKind::inequality) == 0, "Simbody's constraints are equations");
  using Bodies = SimTK::Array_<SimTK::Transform, SimTK::ConstrainedBodyIndex>;
  using Rates = SimTK::Array_<SimTK::SpatialVec, SimTK::ConstrainedBodyIndex>;
  using Forces = SimTK::Array_<SimTK::SpatialVec, SimTK::ConstrainedBodyIndex>;
  using Base = SimTK::Constraint::Custom::Implementation;
  template <class Index>
  using Numbers = SimTK::Array_<SimTK::Real, Index>;

 public:
  using Parameters = typename Block::template Parameters<double>;

  Equations(SimTK::SimbodyMatterSubsystem& matter, const SimTK::MobilizedBody* const (&bodies)[count],
            const Parameters& p)
      : Base(matter, rows_of<Block>(RowKind::equality), rows_of<Block>(RowKind::velocity), 0), parameters_(p) {
    for (int i = 0; i < count; ++i) indices_[i] = addConstrainedBody(*bodies[i]);
    addConstrainedBody(matter.Ground());  // so that all is measured in its frame
  }
  void realizeTopology(SimTK::State& state) const override {
    if (counts_turns())
      last_ = this->getMatterSubsystem().allocateAutoUpdateDiscreteVariable(
          state, SimTK::Stage::Position, new SimTK::Value<SimTK::Vector>(SimTK::Vector(angles, SimTK::NaN)),
          SimTK::Stage::Position);
  }
  Base* clone() const override { return new Equations(*this); }

  void calcPositionErrors(const SimTK::State& state, const Bodies& X, const Numbers<SimTK::ConstrainedQIndex>&,
                          SimTK::Array_<SimTK::Real>& errors) const override {
    spatial::Pose<double> q[count];
    for (int i = 0; i < count; ++i) q[i] = pose_of(getBodyTransform(X, indices_[i]));
    SimTK::Vector now(angles);
    double C[n];
    Block::position(q, counted(state, q, now), state.getTime(), C);
    take(C, RowKind::equality, errors);
    if (!counts_turns()) return;
    const auto& matter = this->getMatterSubsystem();
    SimTK::Value<SimTK::Vector>::updDowncast(matter.updDiscreteVarUpdateValue(state, last_)) = now;
    matter.markDiscreteVarUpdateValueRealized(state, last_);
  }
  void calcPositionDotErrors(const SimTK::State& state, const Rates& V, const Numbers<SimTK::ConstrainedQIndex>&,
                             SimTK::Array_<SimTK::Real>& errors) const override {
    rates(state, V, RowKind::equality, errors);
  }
  void calcPositionDotDotErrors(const SimTK::State& state, const Rates& A, const Numbers<SimTK::ConstrainedQIndex>&,
                                SimTK::Array_<SimTK::Real>& errors) const override {
    accelerations(state, A, RowKind::equality, errors);
  }
  void addInPositionConstraintForces(const SimTK::State& state, const SimTK::Array_<SimTK::Real>& multipliers,
                                     Forces& forces, Numbers<SimTK::ConstrainedQIndex>&) const override {
    add_forces(state, multipliers, RowKind::equality, forces);
  }

  void calcVelocityErrors(const SimTK::State& state, const Rates& V, const Numbers<SimTK::ConstrainedUIndex>&,
                          SimTK::Array_<SimTK::Real>& errors) const override {
    rates(state, V, RowKind::velocity, errors);
  }
  void calcVelocityDotErrors(const SimTK::State& state, const Rates& A, const Numbers<SimTK::ConstrainedUIndex>&,
                             SimTK::Array_<SimTK::Real>& errors) const override {
    accelerations(state, A, RowKind::velocity, errors);
  }
  void addInVelocityConstraintForces(const SimTK::State& state, const SimTK::Array_<SimTK::Real>& multipliers,
                                     Forces& forces, Numbers<SimTK::ConstrainedUIndex>&) const override {
    add_forces(state, multipliers, RowKind::velocity, forces);
  }

 private:
  static constexpr int angles = sizeof...(Coordinates);

  bool counts_turns() const {
    [[maybe_unused]] Parameters p = parameters_;
    return ((Coordinates::turns(p) != nullptr) || ...);
  }
  // The parameters with the turns that bring each angle nearest to that of the last step; `now`: these angles.
  template <class Poses>
  Parameters counted(const SimTK::State& state, const Poses& q, SimTK::Vector& now) const {
    Parameters p = parameters_;
    if (!counts_turns()) return p;
    const SimTK::Vector& last =
        SimTK::Value<SimTK::Vector>::downcast(this->getMatterSubsystem().getDiscreteVariable(state, last_));
    int i = 0;
    [[maybe_unused]] const auto count_one = [&](auto coordinate) {
      using Coordinate = decltype(coordinate);
      double* const turns = Coordinate::turns(p);
      double C[1] = {0};
      if (turns != nullptr) {
        Coordinate::position(q, p, state.getTime(), C);
        if (!SimTK::isNaN(last[i])) *turns = plain::whole_turns<Coordinate>(C[0], last[i]);
        C[0] += *turns;
      }
      now[i++] = C[0];
    };
    (count_one(Coordinates()), ...);
    return p;
  }

  struct Evaluated {
    spatial::Pose<double> q[count];
    Parameters p;
    double C[n];
    typename Block::template Jacobian<double> J;
  };
  Evaluated evaluated(const SimTK::State& state) const {
    Evaluated at;
    for (int i = 0; i < count; ++i) at.q[i] = pose_of(getBodyTransformFromState(state, indices_[i]));
    SimTK::Vector now(angles);
    at.p = counted(state, at.q, now);
    Block::jacobian(at.q, at.p, state.getTime(), at.C, at.J);
    return at;
  }
  // The rows of one kind, in their order.
  static void take(const double (&all)[n], RowKind kind, SimTK::Array_<SimTK::Real>& some) {
    unsigned next = 0;
    for (int i = 0; i < n; ++i)
      if (Block::row_kinds[i] == kind) some[next++] = all[i];
  }
  // J v + dC/dt
  void rates(const SimTK::State& state, const Rates& V, RowKind kind, SimTK::Array_<SimTK::Real>& errors) const {
    const Evaluated at = evaluated(state);
    spatial::Velocity<double> v[count];
    for (int i = 0; i < count; ++i) v[i] = velocity_of(getBodyVelocity(V, indices_[i]));
    double Jv[n], C_t[n];
    Block::velocity(at.J, v, Jv);
    Block::time_derivative(at.q, at.p, state.getTime(), C_t);
    for (int i = 0; i < n; ++i) Jv[i] += C_t[i];
    take(Jv, kind, errors);
  }
  // J a - gamma
  void accelerations(const SimTK::State& state, const Rates& A, RowKind kind,
                     SimTK::Array_<SimTK::Real>& errors) const {
    const Evaluated at = evaluated(state);
    spatial::Velocity<double> v[count], a[count];
    for (int i = 0; i < count; ++i) {
      v[i] = velocity_of(getBodyVelocityFromState(state, indices_[i]));
      a[i] = velocity_of(getBodyAcceleration(A, indices_[i]));
    }
    double Ja[n], gamma[n];
    Block::velocity(at.J, a, Ja);
    Block::gamma(at.q, v, at.p, state.getTime(), gamma);
    for (int i = 0; i < n; ++i) Ja[i] -= gamma[i];
    take(Ja, kind, errors);
  }
  // J^T lambda
  void add_forces(const SimTK::State& state, const SimTK::Array_<SimTK::Real>& multipliers, RowKind kind,
                  Forces& forces) const {
    const Evaluated at = evaluated(state);
    double D[n][6 * count];
    Block::dense(at.J, D);
    unsigned next = 0;
    for (int i = 0; i < n; ++i) {
      if (Block::row_kinds[i] != kind) continue;
      const double lambda = multipliers[next++];
      for (int b = 0; b < count; ++b) {
        for (int k = 0; k < 3; ++k) {
          forces[indices_[b]][1][k] += lambda * D[i][6 * b + k];
          forces[indices_[b]][0][k] += lambda * D[i][6 * b + 3 + k];
        }
      }
    }
  }

  Parameters parameters_;
  SimTK::ConstrainedBodyIndex indices_[count];
  mutable SimTK::DiscreteVariableIndex last_;  // angles that count turns, at the last step
};

// A handle, as those of Simbody's own constraints; the matter subsystem owns what it stands for.
template <class Block, class... Coordinates>
class Constraint : public SimTK::Constraint::Custom {
 public:
  using Parameters = typename Block::template Parameters<double>;

  template <class... Bodies>
  explicit Constraint(const Parameters& p, SimTK::MobilizedBody& first, Bodies&... others)
      : Custom(make(first.updMatterSubsystem(), p, &first, &others...)) {}

 private:
  template <class... Bodies>
  static Equations<Block, Coordinates...>* make(SimTK::SimbodyMatterSubsystem& matter, const Parameters& p,
                                                const Bodies*... bodies) {
    static_assert(sizeof...(Bodies) == Block::bodies, "give each body of the joint");
    const SimTK::MobilizedBody* const all[] = {bodies...};
    return new Equations<Block, Coordinates...>(matter, all, p);
  }
};

}  // namespace cdot::simbody
