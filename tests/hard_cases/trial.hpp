// A hard case: a scene, the ways that claim to hold it, and bounds for numbers. A trial is one run of a case in one
// way. Its findings are printed, tested and written to the table of README.md.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <cdot/effects.hpp>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "tests/hard_cases/ways.hpp"

namespace cdot::hard {

inline constexpr double h = 1.0 / 60;  // the step, unless a scene or its criterion has another [s]
inline constexpr double g = 9.81;
inline constexpr double pi = 3.14159265358979323846;
inline constexpr double finite_only = std::numeric_limits<double>::infinity();

// Holds if value <= bound; with finite_only, if the value is finite.
struct Finding {
  std::string what;  // "gap [m]"
  double value, bound;
  bool held() const;
  bool together() const;
};

// Extremes at the ends of a run's steps.
struct Watch {
  double gap = 0;             // the largest |C| of any joint [m], [rad]
  double rise = 0, fall = 0;  // change of the energy since the start [J]
  double speed = 0;           // of the fastest body [m/s]
  bool finite = true;
  double drift() const { return rise > fall ? rise : fall; }
};

using AnyWorld = std::variant<World<double>, World<float>, SpatialWorld<double>, SpatialWorld<float>>;

// Moves the bodies of a trial and copies their states to its World.
class Mover {
 public:
  virtual ~Mover() = default;
  virtual void step(double by) = 0;
  virtual double force(int joint) const = 0;  // as Trial::force()
  virtual int sleeping_islands() const = 0;
};

// If set, another engine moves the bodies of all trials. The World is then in doubles and measures poses and
// velocities.
extern std::function<std::unique_ptr<Mover>(const Scene&, AnyWorld&)> another_engine;

class Trial {
 public:
  Trial(const std::string& scene_file, const Way& way);

  const std::string file;  // below this folder, without .toml
  const Way way;
  Scene scene;  // may be changed until start()

  void start();                          // builds the World of the scene, projected if the scene asks for it
  bool refused(const std::string& why);  // true if start() fails with this reason
  // Runs for `seconds` in steps of the scene, or of `step`; calls `each` after every step. Ends early if the state is
  // not finite.
  Watch run(double seconds, double step = 0, const std::function<void()>& each = {});
  void step(double by);

  double time() const;
  BodyState body(const std::string& name) const;
  Frame frame() const;
  double energy() const;
  double gap() const;  // the largest norm of a joint's present C [m], [rad]
  double norm_of_error(int joint) const;
  double force(int joint) const;  // the norm of the joint's force on its last body [N]; NaN if unknown
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

  // A bound for float may differ, by the resolution of that precision.
  void at_most(const std::string& what, double value, double bound);
  void at_most(const std::string& what, double value, double bound, double bound_in_float);
  void near(const std::string& what, double value, double right, double within);
  void near(const std::string& what, double value, double right, double within, double within_in_float);

  const std::vector<Finding>& findings() const { return findings_; }
  const std::set<std::string>& chosen() const { return chosen_; }  // integrators, by default

  // Thrown at the runtime's first warning: about the method, before or during the run, or about steps that failed or
  // fell back to another method. It ends the trial.
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
  std::set<std::string> chosen_;
  bool listening_ = false;
  long steps_ = 0, next_diagnosis_ = 1;
};

struct Case {
  std::string fault;  // the folder
  std::string scene;  // a file in it, without .toml
  Ways ways;          // ways that claim to hold the case
  std::function<void(Trial&)> run;
  std::string variant = {};  // name of the case among those of the same scene
  bool large = false;        // too large for ways that claim nothing
};

std::string name_of(const Case& hard_case);  // "fault_scene" or "fault_scene_variant"

// In the order of their names.
std::vector<Case> all_cases();

// Registers a case; one object at namespace scope for each.
struct Register {
  explicit Register(Case hard_case);
};

// Runs the case; an exception becomes a finding that fails. `chosen`: the integrators of a run by default.
std::vector<Finding> findings_of(const Case& hard_case, const Way& way, std::string* chosen = nullptr);
// The result of a way that claims nothing: it holds the case, or the runtime gives a reason, or neither.
struct Verdict {
  bool held = false;
  // True if merely inaccurate: every number is finite and every gap within ten times its bound.
  bool together = true;
  std::string said, off;  // off: the findings that fail
};
Verdict verdict_on(const Case& hard_case, const Way& way);

// The text of README.md, and the start of a case's row without measured numbers.
std::string table(const std::vector<Case>& cases);
std::string table_row_start(const Case& hard_case);

}  // namespace cdot::hard
