// The state of a World -> the matrix of its whole system, and its conflict graph.
#include <Eigen/QR>
#include <algorithm>

#include <cdot/jacobian.hpp>
#include <cdot/spaces.hpp>

#include "runtime/state/probe.hpp"

namespace cdot {
namespace {

// A row with a pivot below this share of the largest is redundant.
constexpr double rank_tolerance = 1e-10;

template <class S>
void list_bodies(const WorldData<S>& world, SystemMatrix& system) {
  using T = typename S::Scalar;
  using Velocity = typename S::Velocity;
  static_assert(sizeof(Velocity) == S::freedom * sizeof(T));
  for (int i = 0; i < world.bodies.count(); ++i) {
    if (world.bodies.immovable(i)) continue;
    system.bodies.push_back(i);
    for (int c = 0; c < S::freedom; ++c) {
      Velocity unit{};
      reinterpret_cast<T*>(&unit)[c] = T(1);
      const Velocity moved = S::weighted(world.bodies.inverse_mass[i], unit);
      system.frozen.push_back(reinterpret_cast<const T*>(&moved)[c] == T(0));
    }
  }
  system.columns = S::freedom * static_cast<int>(system.bodies.size());
}

// Its rows of D and of (M^-1 D^T)^T.
template <class S>
void add_joint(const WorldData<S>& world, int joint, SystemMatrix& system, std::vector<double>& weighted) {
  const JointRecord& record = world.joints[joint];
  Probe<S> probe(world);
  probe.look_at(record);
  const int rows = probe.rows(), width = S::freedom * static_cast<int>(record.bodies.size());
  std::vector<double> J(static_cast<size_t>(rows * width)), W = J;
  probe.dense(J.data(), W.data());
  SystemMatrix::Joint entry{joint, system.rows, rows, {}};
  const auto first = static_cast<size_t>(system.rows * system.columns);
  system.rows += rows;
  for (auto* matrix : {&system.D, &weighted}) matrix->resize(static_cast<size_t>(system.rows * system.columns), 0.0);
  for (size_t k = 0; k < record.bodies.size(); ++k) {
    const auto found = std::lower_bound(system.bodies.begin(), system.bodies.end(), record.bodies[k]);
    if (found == system.bodies.end() || *found != record.bodies[k]) continue;
    const auto at = static_cast<int>(found - system.bodies.begin());
    entry.body.push_back(at);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < S::freedom; ++c) {
        const size_t to = first + static_cast<size_t>(r * system.columns + S::freedom * at + c);
        const size_t from = static_cast<size_t>(r * width + S::freedom * static_cast<int>(k) + c);
        system.D[to] += J[from];
        weighted[to] += W[from];
      }
  }
  system.joints.push_back(std::move(entry));
}

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Columns in which nothing can move add neither to the rank nor to the freedom.
void find_rank(SystemMatrix& system) {
  Matrix D = Eigen::Map<const Matrix>(system.D.data(), system.rows, system.columns);
  int free = 0;
  for (int c = 0; c < system.columns; ++c) {
    if (system.frozen[c]) D.col(c).setZero();
    free += !system.frozen[c];
  }
  if (system.rows > 0 && system.columns > 0) {
    Eigen::ColPivHouseholderQR<Matrix> qr(system.rows, system.columns);
    qr.setThreshold(rank_tolerance);
    system.rank = static_cast<int>(qr.compute(D).rank());
  }
  system.degrees_of_freedom = free - system.rank;
}

}  // namespace

bool SystemMatrix::empty_block(const Joint& joint, int at) const {
  for (int r = joint.first; r < joint.first + joint.rows; ++r)
    for (int c = 0; c < freedom; ++c)
      if (entry(r, freedom * at + c) != 0) return false;
  return true;
}

template <class S>
SystemMatrix system_matrix(BasicWorld<S>& world) {
  const WorldData<S>& data = world.data();
  SystemMatrix system;
  system.freedom = S::freedom;
  list_bodies(data, system);
  std::vector<double> weighted;
  for (int joint = 0; joint < world.joint_count(); ++joint)
    if (!data.joints[joint].places.empty() && !data.joints[joint].broken) add_joint(data, joint, system, weighted);
  const Eigen::Map<const Matrix> D(system.D.data(), system.rows, system.columns);
  const Eigen::Map<const Matrix> W(weighted.data(), system.rows, system.columns);
  system.K.resize(static_cast<size_t>(system.rows) * static_cast<size_t>(system.rows));
  Eigen::Map<Matrix>(system.K.data(), system.rows, system.rows) = D * W.transpose();
  find_rank(system);
  return system;
}

ConflictGraph conflicts(const SystemMatrix& system) {
  ConflictGraph graph;
  const int joints = static_cast<int>(system.joints.size());
  for (int i = 0; i < joints; ++i) {
    std::vector<char> taken(static_cast<size_t>(joints) + 1, 0);
    for (int j = 0; j < i; ++j) {
      const std::vector<int>&a = system.joints[j].body, &b = system.joints[i].body;
      if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) == a.end()) continue;
      graph.edges.emplace_back(j, i);
      taken[graph.colour[j]] = 1;
    }
    graph.colour.push_back(static_cast<int>(std::find(taken.begin(), taken.end(), 0) - taken.begin()));
    graph.colours = std::max(graph.colours, graph.colour.back() + 1);
  }
  std::sort(graph.edges.begin(), graph.edges.end());
  return graph;
}

#define CDOT_INSTANTIATE(S) template SystemMatrix system_matrix(BasicWorld<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
