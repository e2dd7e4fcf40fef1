#include "runtime/tool/watch/release_watch.hpp"

#include <algorithm>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/events/guarded.hpp"
#include "runtime/tool/watch/watched_ends.hpp"

namespace cdot {
namespace {

using Vector = std::array<double, 3>;

// to - from, at most six numbers.
BodyError difference(const double (&from)[3], const double (&to)[3]) {
  return {{}, {}, {to[0] - from[0], to[1] - from[1]}, {0, 0, to[2] - from[2]}};
}
BodyError difference(const double (&from)[6], const double (&to)[6]) {
  return {
      {}, {}, {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, {to[3] - from[3], to[4] - from[4], to[5] - from[5]}};
}

double square(const Vector& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

// The smaller velocity and the smaller spin of both.
BodyError smaller(const BodyError& a, const BodyError& b) {
  return {{},
          {},
          square(a.velocity) < square(b.velocity) ? a.velocity : b.velocity,
          square(a.spin) < square(b.spin) ? a.spin : b.spin};
}

void scale(BodyError& a, double by) {
  for (Vector* part : {&a.velocity, &a.spin})
    for (double& number : *part) number *= by;
}

void subtract(Vector& from, const Vector& a) {
  for (std::size_t k = 0; k < from.size(); ++k) from[k] -= a[k];
}

template <class S>
bool is_free(const WorldData<S>& world, int body) {
  return std::ranges::none_of(world.joints, [&](const JointRecord& joint) {
    const bool holds = std::ranges::any_of(joint.places, [&](const Place& p) { return !world.batches[p.batch]->law; });
    return holds && !joint.broken && std::ranges::find(joint.bodies, body) != joint.bodies.end();
  });
}

}  // namespace

template <class S>
bool ReleaseWatch<S>::is_needed(const WorldData<S>& world) {
  return !world.bonds.empty() || std::ranges::any_of(world.batches, [](const auto& batch) { return tears(*batch); });
}

template <class S>
void ReleaseWatch<S>::before_step(const WorldData<S>& world) {
  const bool first = before_.empty();
  std::swap(earlier_, before_);
  before_.assign(world.bodies.velocity.begin(), world.bodies.velocity.end());
  if (!first) return;
  find_ends(world, 0, world.time);  // before the run
  waiting_.clear();
}

template <class S>
void ReleaseWatch<S>::after_step(const WorldData<S>& world, double h, double time) {
  ++steps_;
  wait_on(world, h);
  find_ends(world, h, time);
  length_ = h;
}

template <class S>
void ReleaseWatch<S>::wait_on(const WorldData<S>& world, double h) {
  for (Waiting& one : waiting_) {
    Release& release = one.release;
    BodyError now = change_of(release.body, before_, world.bodies.velocity);
    scale(now, one.length / h);
    if (++one.steps == 1) {
      one.after = now;
      continue;
    }
    one.after = smaller(one.after, now);
    note(one);
  }
  std::erase_if(waiting_, [](const Waiting& one) { return one.steps == 2; });
}

template <class S>
void ReleaseWatch<S>::note(Waiting one) {
  BodyError& error = one.release.error;
  subtract(error.velocity, one.after.velocity), subtract(error.spin, one.after.spin);
  scale(error, one.late / one.length);
  found_.push_back(one.release);
}

template <class S>
double ReleaseWatch<S>::end_wait(int body) {
  const auto one = std::ranges::find_if(
      waiting_, [&](const Waiting& other) { return other.release.body == body && other.steps == 1; });
  if (one == waiting_.end()) return 0;
  const double late = one->late;
  note(*one);
  waiting_.erase(one);
  return late;
}

template <class S>
void ReleaseWatch<S>::find_ends(const WorldData<S>& world, double h, double time) {
  broken_.resize(world.bonds.size()), ended_.resize(world.batches.size());
  for (std::size_t k = 0; k < world.bonds.size(); ++k) {
    const int joint = world.bonds[k].joint;
    const bool is = world.joints[joint].broken, was = std::exchange(broken_[k], is);
    if (is && !was) add_island_of(world, joint, h, time);
  }
  for (std::size_t k = 0; k < world.batches.size(); ++k) {
    const Batch<S>& batch = *world.batches[k];
    if (!tears(batch)) continue;
    each_kept<S, char>(batch, ended_[k], 1, 0, [&](int slot, char* ended) {
      const bool is = has_ended(batch, slot) && ends_by_load(batch, slot), was = std::exchange(*ended, is);
      if (is && !was) add_island_of(world, batch.joint[slot], h, time);
    });
  }
}

template <class S>
void ReleaseWatch<S>::add_island_of(const WorldData<S>& world, int joint, double h, double time) {
  const Island<S>& island = world.islands[static_cast<std::size_t>(island_of_joint(world, joint))];
  const int front = island.bodies.front();
  const auto waits = [&](const Waiting& one) { return one.release.body == front && one.steps == 0; };
  if (island.flow.locates || std::ranges::any_of(waiting_, waits)) return;
  if (steps_ <= 2 && has_unlimited_motor(island)) return;
  for (const int body : island.bodies) {
    BodyError change = change_of(body, before_, world.bodies.velocity);
    const double late = end_wait(body);
    if (!earlier_.empty() && late == 0) {
      BodyError earlier = change_of(body, earlier_, before_);
      scale(earlier, h / length_);
      change = smaller(earlier, change);
    }
    waiting_.push_back({{time, body, is_free(world, body), change}, h, late + h, {}});
  }
}

template <class S>
BodyError ReleaseWatch<S>::change_of(int body, const Velocities& from, const Velocities& to) const {
  const auto write = [&](const Velocities& of, double(&numbers)[S::freedom]) {
    typename S::Scalar own[S::freedom];
    S::write(of[static_cast<std::size_t>(body)], own);
    std::ranges::copy(own, numbers);
  };
  double before[S::freedom], after[S::freedom];
  write(from, before), write(to, after);
  return difference(before, after);
}

#define CDOT_INSTANTIATE(S) template class ReleaseWatch<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
