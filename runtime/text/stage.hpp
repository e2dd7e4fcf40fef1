// The stage that a long command is in: told where it begins, shown by whoever waits for it.
#pragma once

#include <atomic>

namespace cdot::text {

using StageName = std::atomic<const char*>;  // a literal; null before the first stage

// Where this process tells its stage. A child tells it in memory that its parent reads.
inline StageName*& place_of_stage() {
  static StageName own{nullptr};
  static StageName* place = &own;
  return place;
}

// From here to the end of its scope.
class Stage {
 public:
  explicit Stage(const char* name) : before_(place_of_stage()->exchange(name)) {}
  ~Stage() { place_of_stage()->store(before_); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

 private:
  const char* before_;
};

}  // namespace cdot::text
