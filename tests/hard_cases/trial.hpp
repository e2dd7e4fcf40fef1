// A hard case: a scene, the ways that claim to hold it, and what must come out, as numbers. A trial is one run of it in
// one way; what it finds is printed, tested and put into the table of README.md.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <cdot/effects.hpp>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "tests/hard_cases/ways.hpp"

namespace cdot::hard {

inline constexpr double h = 1.0 / 60;  // the step, unless a scene or its criterion says otherwise [s]
inline constexpr double g = 9.81;
inline constexpr double pi = 3.14159265358979323846;
inline constexpr double finite_only = std::numeric_limits<double>::infinity();

// value <= bound is to hold; a bound of finite_only asks for a number, whichever.
struct Finding {
  std::string what;  // "gap [m]"
  double value, bound;
  bool held() const;
  bool together() const;
};

// What was seen at the ends of the steps of a run.
struct Watch {
  double gap = 0;             // the largest |C| of any joint [m], [rad]
  double rise = 0, fall = 0;  // of the energy, against the start [J]
  double speed = 0;           // of the fastest body [m/s]
  bool finite = true;
  double drift() const { return rise > fall ? rise : fall; }
};

using AnyWorld = std::variant<World<double>, World<float>, SpatialWorld<double>, SpatialWorld<float>>;

// Moves the bodies of a trial, and puts into its World where they went.
class Mover {
 public:
  virtual ~Mover() = default;
  virtual void step(double by) = 0;
  virtual double force(int joint) const = 0;  // as Trial::force()
  virtual int sleeping_islands() const = 0;
};

// Who moves the bodies of all trials, if not their Worlds: another engine. Its World is one of doubles and measures
// poses and velocities.
extern std::function<std::unique_ptr<Mover>(const Scene&, AnyWorld&)> another_engine;

class Trial {
 public:
  Trial(const std::string& scene_file, const Way& way);

  const std::string file;  // below this folder, without .toml
  const Way way;
  Scene scene;  // may be changed until start()

  void start();                          // the World of the scene, on its joints if the scene asks for it
  bool refused(const std::string& why);  // start(), which is to fail and to say this
  // Goes on for so many seconds in steps of the scene, or of `step`; `each` is called after every one. Ends early if
  // something is not finite.
  Watch run(double seconds, double step = 0, const std::function<void()>& each = {});
  void step(double by);

  double time() const;
  BodyState body(const std::string& name) const;
  Frame frame() const;
  double energy() const;
  double gap() const;  // the largest norm of a joint's C now [m], [rad]
  double norm_of_error(int joint) const;
  double force(int joint) const;  // the norm of what the joint exerts on its last body [N]; NaN if nobody knows
  double coordinate(int joint, const char* name) const;
  int sleeping_islands() const;
  bool finite() const;
  int joint_named(const std::string& name) const;
  int body_named(const std::string& name) const;

  template <class Ask>
  decltype(auto) ask(Ask question) const {
    return std::visit(question, *world_);
  }
  template <class Change>
  decltype(auto) change(Change change) {
    return std::visit(change, *world_);
  }

  // In float the bound may be another: what that precision can tell apart.
  void at_most(const std::string& what, double value, double bound);
  void at_most(const std::string& what, double value, double bound, double bound_in_float);
  void near(const std::string& what, double value, double right, double within);
  void near(const std::string& what, double value, double right, double within, double within_in_float);

  const std::vector<Finding>& findings() const { return findings_; }

  // What the runtime says of itself to whoever listens: of the method, before and while running, and of steps that fail
  // or that were left to another method. The trial ends with it.
  struct Warned {
    std::string what;
  };
  void listen() { listening_ = true; }

 private:
  void diagnose(double by);
  void say(const std::string& what);

  std::unique_ptr<AnyWorld> world_;
  std::unique_ptr<Mover> mover_;
  std::vector<Finding> findings_;
  bool listening_ = false;
  long steps_ = 0, next_diagnosis_ = 1;
};

struct Case {
  std::string fault;  // the folder
  std::string scene;  // a file in it, without .toml
  Ways ways;          // that claim to hold it
  std::function<void(Trial&)> run;
  std::string variant = {};  // tells cases of the same scene apart, in words
  bool large = false;        // too large to be tried in ways that claim nothing
};

std::string name_of(const Case& hard_case);  // "fault_scene" or "fault_scene_variant"

// In the order of their names.
std::vector<Case> all_cases();

// One at namespace scope per case makes it known.
struct Register {
  explicit Register(Case hard_case);
};

// Runs it; what is thrown becomes a finding that does not hold.
std::vector<Finding> findings_of(const Case& hard_case, const Way& way);
// Of a way that claims nothing: that it holds the case all the same, or what the runtime says of it, or neither.
struct Verdict {
  bool held = false;
  // Inexact, as a method of low order is, but in one piece: every number finite, every gap within ten times its bound.
  bool together = true;
  std::string said, off;  // off: what does not hold
};
Verdict verdict_on(const Case& hard_case, const Way& way);

// README.md, and how the row of a case begins there: what it has beside measured numbers.
std::string table(const std::vector<Case>& cases);
std::string table_row_start(const Case& hard_case);

}  // namespace cdot::hard
