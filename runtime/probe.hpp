// One joint or coordinate evaluated at the present poses without touching the World's own rows:
// what every question about a World is answered from.
#pragma once

#include "runtime/joint_table.hpp"
#include "runtime/world_state.hpp"

namespace cdot {

template <class S>
class Probe {
 public:
  using T = typename S::Scalar;
  explicit Probe(const WorldState<S>& world) : world_(world) {}

  // The rows of a joint, or the row of one of its coordinates, with no body taken as immovable.
  void look_at(const JointRecord& joint, int coordinate = -1) {
    const JointEntry<S>& entry = joint_entries<S>()[joint.type];
    ops_ = coordinate < 0 ? entry.rows.general : entry.coordinates[coordinate].general;
    batch_.ops = ops_;
    batch_.body = joint.bodies;
    batch_.parameters.assign(joint.parameters.begin(), joint.parameters.end());
    batch_.jacobian.assign(static_cast<size_t>(ops_->jacobian_size), T(0));
    for (auto* array : {&batch_.C, &batch_.bias, &batch_.scratch})
      array->assign(static_cast<size_t>(ops_->rows), T(0));
    ops_->evaluate(batch_, 0, 1, world_.bodies, T(world_.time));
  }

  int rows() const { return ops_->rows; }
  double C(int row) const { return batch_.C[row]; }

  // J v + dC/dt of every row.
  const std::vector<T>& Cdot() {
    ops_->velocity(batch_, 0, 1, world_.bodies.velocity.data(), batch_.scratch.data());
    for (int r = 0; r < ops_->rows; ++r) batch_.scratch[r] += batch_.bias[r];
    return batch_.scratch;
  }

  // J^T lambda on the body at this position of the joint.
  typename S::Velocity impulse_on(int position, const std::vector<T>& lambda) const {
    std::vector<typename S::Velocity> impulses(static_cast<size_t>(ops_->bodies));
    ops_->transposed(batch_, 0, lambda.data(), impulses.data());
    return impulses[position];
  }

 private:
  const WorldState<S>& world_;
  const BlockOps<S>* ops_ = nullptr;
  Batch<S> batch_;
};

// lambda of a joint's rows in the last substep, drift correction included; zeros where it has none.
template <class S>
std::vector<typename S::Scalar> total_impulse(const WorldState<S>& world,
                                              const JointRecord& joint) {
  const auto rows = joint_types()[joint.type].row_kinds.size();
  std::vector<typename S::Scalar> lambda(rows, 0);
  if (joint.places.empty() || joint.broken) return lambda;
  const Batch<S>& batch = *world.batches[joint.places[0].batch];
  for (size_t r = 0; r < rows; ++r) {
    const size_t i = joint.places[0].slot * rows + r;
    lambda[r] = batch.lambda[i] + batch.correction[i];
  }
  return lambda;
}

}  // namespace cdot
