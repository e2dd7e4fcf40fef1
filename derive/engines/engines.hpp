// A kernel and the adapter of an engine to a header that makes the joint one of that engine.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {

struct Adapter {
  std::string_view name, text;
};

struct Engine {
  std::string_view name;                      // "bullet"
  std::string_view title;                     // "Bullet 3: a btTypedConstraint"
  std::string_view base;                      // of the joint's class: "bullet::Constraint<BLOCKS>"
  std::string_view parameters;                // of the class: "template <class T>", if any
  int dimension = 0;                          // 0: of the plane and of space
  int most_bodies = 0;                        // 0: as many as the joint joins
  std::vector<Adapter> adapters{};            // each after those that it uses
  std::vector<std::string_view> functions{};  // of the contract; none: all
  bool bounds = true;                         // it has rows C >= 0
  bool drives = true;                         // motors and limits are the adapter's
};

std::span<const Engine> engines();
const Engine& engine_named(std::string_view name);  // throws std::out_of_range

// Thrown for a joint that an engine cannot have; its text says why and what to do.
struct CannotEmit : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A header and what it includes of Cdot: all joints for one engine share `common`.
struct EmittedJoint {
  std::string common_name, common;  // "cdot_bullet.hpp"
  std::string joint;
};
EmittedJoint emit_for(const Engine& engine, const Kernel& kernel);
// Both in one file.
std::string single_header(const Engine& engine, const Kernel& kernel);

}  // namespace cdot::derive
