// A kernel as programs: every function of the contract (runtime/include/cdot/kernel.hpp) as a program, before it
// becomes text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"
#include "derive/expression/components.hpp"
#include "derive/expression/substitution.hpp"
#include "derive/program/effort.hpp"
#include "derive/program/program.hpp"

namespace cdot::derive {

// One number stored by Jacobian<T>.
struct Field {
  std::string name;
  Expr value;   // computed by `jacobian`, in components
  Expr entry;   // the same over vectors, where it is a whole entry of J
  Expr symbol;  // how later functions refer to it
};

// A function of the contract. Inputs are found by the names of the program's input operations.
struct KernelFunction {
  std::string name;            // "jacobian"
  std::string summary;         // "C and J"
  Program program;             // outputs carry the text of what is assigned: "C[0]", "J.t_x"
  bool isotropic = false;      // the overload for bodies whose inertia is a number, in space
  std::vector<Program> other;  // another way to the same outputs, if there is one; the cheaper wins
};

// One row block: the joint, a coordinate, or one of these with a body immovable.
struct KernelBlock {
  std::string name;  // of the struct: "line", "slide", "a_immovable"
  const Block* block = nullptr;
  std::vector<Field> fields;
  std::vector<KernelFunction> functions;
  std::vector<KernelBlock> variants;  // with one body immovable
};

// The bounds of a bounded row of an effect.
struct KernelBound {
  const BoundedRow* row = nullptr;
  int coordinate = 0;                      // its place among those of the joint
  bool in_time = false, of_value = false;  // the bounds depend on the time, on the coordinate
  KernelFunction function;
  std::vector<KernelFunction> others{};  // by_load, after, until
};

// An effect on the coordinate of any joint in this unit; "joint": on a joint itself.
struct OnCoordinate {
  // Of a parameter there: not read; to be given; has a default; by default the value of the coordinate.
  enum Use { none, required, by_default, value };
  std::string unit;
  std::vector<Use> uses;  // by parameter
};
// Nothing if the law of the effect is about more than one coordinate.
std::optional<OnCoordinate> on_coordinate(const Joint& joint);

// The force on a coordinate is linear in it and in its rate if its slopes read neither these nor the time and cannot be
// negative: an implicit step is then exact.
struct SlopesOfLaw {
  bool linear = false, vanish = false;
};
SlopesOfLaw slopes_of(const Joint& joint, const DerivedLaw& law);
// By row: false for rows without a force, which only tell the law where a direction points.
std::vector<bool> acts_of(const DerivedLaw& law);
bool depends_on_time(const DerivedLaw& law);

struct DefaultValue {
  int parameter = 0;
  Program program;  // outputs "p.t_x", ...
};

struct Kernel {
  const Derivation* derivation = nullptr;  // every block is one of its blocks
  KernelBlock rows;
  std::vector<KernelBlock> coordinates;
  std::vector<KernelBound> bounded;
  std::vector<DefaultValue> defaults;
};

Kernel plan(const Derivation& derivation);
bool depends_on_time(const Block& block);  // C or J v
// Work of the searches for cheap programs, in the units of program/effort.hpp: of all of a kernel, and of each one. The
// costliest kernel of the catalogue takes 21 million. A second of a usual machine does some 20 million, so that kernels
// of four bodies and six rows take at most 20 s with their proof.
struct SearchBounds {
  std::int64_t kernel, program;
};
inline constexpr SearchBounds usual_bounds = {150'000'000, 60'000'000};
// A function whose search a bound ended: a cheaper program may exist.
struct CutShort {
  std::string function;  // "jacobian"
  int operations = 0;    // of the cheapest program so far
};
// Common terms and factors shared in every function; of two ways, the cheaper one. Adds to `cut_short`, if given.
Kernel simplified(Kernel kernel, std::vector<CutShort>* cut_short = nullptr, SearchBounds bounds = usual_bounds);

// Writes expressions out in components of poses and parameters: an arm becomes c l_x - s l_y, in space xx l_x + xy l_y
// + xz l_z. Kernels, ledger and hand derivations share it, so all are counted alike.
class PoseInputs {
 public:
  // Products with vectors that are fixed in `in_axes_of` are taken in the axes of this body
  // (expression/components.hpp). The z axes of the frames `crossed` are x × y: 9 operations, 15 turned into the world.
  explicit PoseInputs(const Joint& joint, int in_axes_of = -1, const std::vector<std::string>& crossed = {});
  PoseInputs(const PoseInputs&) = delete;  // a member knows another by its address
  Expr of(Expr scalar);                    // any scalar expression of the joint

 private:
  void rotate(const Joint& joint, const Parameter& parameter, bool crossed);
  void fix(const Joint& joint, int body);

  std::map<const Node*, Expr> rotated_;
  std::optional<LocalAxes> axes_;
  std::optional<Components> components_;
  std::optional<Substitution> rotation_;
};

// The frames on bodies of which these outputs, in components of poses and parameters, read all three axes.
std::vector<std::string> whole_frames(const Joint& joint, const std::vector<NamedExpr>& outputs);

// Adds energy, force, unstored and slopes.
void plan_law(const Joint& joint, const DerivedLaw& law, std::vector<KernelFunction>& functions);
KernelBound plan_bound(const Joint& joint, const BoundedRow& row, const DerivedBound& derived);
// The leaf of a coordinate in the bounds of its rows.
inline constexpr const char* bounded_value = "value of the bounded coordinate";
inline constexpr const char* bounded_rate = "rate of the bounded coordinate";
inline constexpr const char* bounded_load = "force of the bounded row";

// The default of a parameter that has one, in its own frame.
DefaultValue plan_default(const Joint& joint, int index);

// The numbers of a parameter in Parameters<T>, by name: "pa_x", "pa_y"; "phi"; of a frame in space "f_x_x" to "f_z_z".
std::vector<std::string> fields_of(const Joint& joint, const Parameter& parameter);
// The symbols by which a kernel reads these numbers, in the same order.
std::vector<Expr> local_symbols(const Joint& joint, const Parameter& parameter);

}  // namespace cdot::derive
