// The kernel of a spec as programs, by the pipeline that writes generated/.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "derive/language/specs_folder.hpp"
#include "derive/program/program.hpp"

namespace cdot::compile {

// Rows of a joint or of an effect, or the one row of a coordinate.
struct RowPrograms {
  std::vector<std::string> names;
  std::vector<std::string> fields;                   // of Jacobian<T>
  bool has_rates = false;                            // dC/dt at fixed q is not 0
  std::map<std::string, derive::Program> functions;  // by the names of the kernel contract; of an effect with its law

  const derive::Program& function(const std::string& name) const { return functions.at(name); }
  bool has(const std::string& function) const { return functions.contains(function); }
  std::size_t count() const { return names.size(); }
};

// A row with bounds of an effect.
struct BoundPrograms {
  std::string coordinate;
  bool of_rate = false;    // else its ends
  derive::Program bounds;  // of C and the time: B.lower, B.upper, B.rate
  // Of C, its rate and the time: D, the distance from the event at which the row begins or ends to act.
  std::optional<derive::Program> after, until;
  std::optional<derive::Program> breaks;   // of the load on a joint and the time: D, the distance from the joint's end
  std::optional<derive::Program> by_load;  // B.lower, B.upper: what each unit of its load adds to them
  bool has_events() const { return after || until; }
};

struct SpecPrograms {
  std::vector<std::string> bodies;      // "a", "b", ...
  std::vector<std::string> parameters;  // what the programs read, in the order of Parameters<T>: "p.pa_x", "phi"
  RowPrograms rows;
  std::map<std::string, RowPrograms> coordinates;
  std::map<std::string, std::string> leaves;  // of an effect's law: "turn_rate" -> "rate[0]"
  std::vector<BoundPrograms> bounded;
};

// With these of its coordinates, and those of its rows with bounds; spec: "planar/revolute". stiffness: that of the
// rows too. They are derived once in a process: a bill asks for those of every part again and again.
SpecPrograms programs_of(const derive::SpecsFolder& specs, const std::string& spec,
                         const std::set<std::string>& coordinates, bool stiffness);

}  // namespace cdot::compile
