// Errors of velocities where a joint breaks, or a row ends, in steps of equal length.
//
// Such steps know a load by its mean over a step, which is that in the middle of the step. A force that ends at a
// strength, found in step k, has ended between the middle of step k - 1 and that of step k. It acts until the end of
// step k: by h too long, give or take h/2. The velocities err by h (a- - a+), where a- and a+ are the accelerations
// before and after: in step k - 1 or k, and k + 1 or k + 2, of each pair the smaller, as the other may hold a blow. A
// force that ends in step k + 1 because of that would have ended with the first one: it acts by one h more than that,
// and a- and a+ are those of the steps k + 1 and k + 2 alone. In the first two steps of a run a motor of unlimited
// force may have given a blow: then there is no telling.
#pragma once

#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/watch/errors_by_rates.hpp"

namespace cdot {

struct Release {
  double time;  // [s], of the end of step k
  int body;
  bool free;        // no joint holds the body any more
  BodyError error;  // of the velocity and the spin alone
};

template <class S>
class ReleaseWatch {
 public:
  // False if no force can end.
  static bool is_needed(const WorldData<S>& world);
  // Before and after every step of h, which ends at `time`.
  void before_step(const WorldData<S>& world);
  void after_step(const WorldData<S>& world, double h, double time);
  const std::vector<Release>& found() const { return found_; }

 private:
  using Velocities = std::vector<typename S::Velocity>;  // by body
  struct Waiting {
    Release release;
    double length;    // of step k [s]
    double late;      // by so much the force has ended too late [s]
    BodyError after;  // the change in step k + 1, over that length
    int steps = 0;    // taken since
  };

  void wait_on(const WorldData<S>& world, double h);
  void note(Waiting one);
  // Notes what the body waits for since the step before. Returns by how much that force ended too late [s]; 0: none.
  double end_wait(int body);
  // Bodies of islands in which a force has ended in this step wait for the next ones.
  void find_ends(const WorldData<S>& world, double h, double time);
  void add_island_of(const WorldData<S>& world, int joint, double h, double time);
  BodyError change_of(int body, const Velocities& from, const Velocities& to) const;

  std::vector<Release> found_;
  std::vector<Waiting> waiting_;
  Velocities before_, earlier_;           // this step, and the one before it
  double length_ = 0;                     // of the one before it [s]
  long long steps_ = 0;                   // so far
  std::vector<char> broken_;              // by bond
  std::vector<std::vector<char>> ended_;  // by batch and home
};

}  // namespace cdot
