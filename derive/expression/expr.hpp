// The generator's own expressions: interned nodes over scalars and vectors, in an order that depends on names only.
//
// Every stage after the reader works on these. Equal expressions are the same node, so comparing is one pointer
// comparison and shared work is shared by construction. The builders below apply the identities that hold whatever the
// operands are (dot(t, t) = 1 for a unit vector, dot(perp u, v) = cross(u, v), ...) and nothing else. A name given by
// the author (`let u = ...`) sticks to the node, and sums do not flatten through it.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "derive/expression/rational.hpp"

namespace cdot::derive {

enum class Kind {
  number,    // value
  symbol,    // a leaf, scalar or vector
  sum,       // coefs[0] args[0] + coefs[1] args[1] + ..., scalars or vectors; a constant term is a number 1
  product,   // args[0]^exponents[0] args[1]^exponents[1] ...; scalars; no number among them
  function,  // fn(args...), scalars
  scale,     // args[0] args[1]: scalar times vector
  dot,       // of two vectors
  cross,     // of two vectors; in the plane the scalar u_x v_y - u_y v_x, in space a vector
  perp,      // (-u_y, u_x), in the plane
  tensor,    // args[0] args[1]: a symmetric tensor leaf applied to a vector, in space
  twist,     // the angle by which a triad is twisted against another about their x axes, in space
  norm,      // length of a vector
  unit       // direction of a vector; the world's x axis for the zero vector
};

enum class Fn : int;  // of expression/functions.hpp, a table
std::string_view name_of(Fn fn);

// The quantity that a leaf stands for. It decides its time derivative and where a kernel reads it.
enum class Role {
  position,         // vector x_a: the centre of mass of a body
  world_vector,     // vector fixed in the world: a parameter as it is, or the world's x axis
  body_vector,      // vector fixed in a body: an arm, a direction, an axis
  angle,            // scalar theta_a
  parameter,        // scalar parameter
  time,             // scalar
  constant,         // scalar pi
  velocity,         // vector v_a
  spin,             // w_a: a scalar in the plane, a vector in space
  inverse_mass,     // scalar
  inverse_inertia,  // scalar; in space the leaf of a tensor, or one of its six components
  multiplier,       // scalar lambda of a row
  given             // any other known quantity: an entry of J handed to K, a free symbol of a hand derivation
};

class Pool;
struct Node;

// A handle to an interned node. Copy freely; valid as long as its pool.
class Expr {
 public:
  Expr() = default;
  explicit Expr(const Node* node) : node_(node) {}
  const Node* operator->() const { return node_; }
  const Node& operator*() const { return *node_; }
  explicit operator bool() const { return node_ != nullptr; }
  friend bool operator==(Expr a, Expr b) = default;

 private:
  const Node* node_ = nullptr;
};

struct Node {
  Pool* pool = nullptr;
  int id = 0;  // in order of creation; never decides what is printed
  Kind kind = Kind::number;
  bool vector = false;
  bool unit_length = false;  // known to have length 1
  Rational value;            // number
  std::string symbol;        // symbol: its name
  Role role = Role::given;   // symbol
  int body = -1;             // symbol: index of its body, -1 for none or the world
  Fn fn{};                   // function
  std::vector<Expr> args;
  std::vector<Rational> coefs;  // sum
  std::vector<int> exponents;   // product
  mutable std::string name;     // given by `let`, or derived from the names of its parts; may be empty
  mutable bool named_by_let = false;
};

// Three axes of a right-handed triad: dot products among them are known, and cross products.
using Triad = std::array<Expr, 3>;

// Owns the nodes of one joint.
class Pool {
 public:
  explicit Pool(int dimension = 2) : dimension_(dimension) {}
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  Expr number(Rational value);
  // The same name always gives the same symbol; its other properties must agree.
  Expr symbol(std::string_view name, Role role, int body = -1);
  Expr vector_symbol(std::string_view name, Role role, int body = -1, bool unit_length = false);
  Expr find(std::string_view name) const;  // empty if there is no such symbol

  int dimension() const { return dimension_; }  // 2 or 3
  // Orthonormal vectors `name`_x, `name`_y, `name`_z, in space.
  Triad triad(std::string_view name, Role role, int body = -1);
  // The triad that a leaf is an axis of, and which one; null if it is none.
  struct Axis {
    const Triad* triad = nullptr;
    int index = -1;
  };
  Axis axis_of(Expr leaf) const;

  // Attaches a name to a node that has none; a let's name wins over one derived from parts.
  void name(Expr e, std::string_view name, bool by_let);

  Expr intern(Node node);  // for the builders below

 private:
  Expr leaf(std::string_view name, Role role, int body, bool vector, bool unit_length);

  struct HashOfContent {
    std::size_t operator()(const Node* node) const;
  };
  struct SameContent {
    bool operator()(const Node* a, const Node* b) const;
  };

  std::deque<Node> nodes_;
  std::unordered_set<const Node*, HashOfContent, SameContent> by_content_;
  std::map<std::string, const Node*, std::less<>> symbols_;
  std::map<std::string, Triad, std::less<>> triads_;
  std::map<const Node*, Axis> axes_;
  int dimension_;
};

// A total order from kinds, roles and names only: the order in which terms are kept and printed.
std::strong_ordering compare(Expr a, Expr b);

bool is_number(Expr e, Rational value);
inline bool is_zero(Expr e) { return is_number(e, 0); }  // also the zero vector: an empty sum
inline bool is_one(Expr e) { return is_number(e, 1); }

struct Term {
  Rational coef;
  Expr e;
};
// e = coef * rest; rest has no numeric factor.
Term split_coefficient(Expr e);
// e as a sum: its terms, or itself as the only one.
std::vector<Term> terms_of(Expr e);

// Builders. Scalars and vectors must fit (asserted); the reader has checked the author's types before.
Expr sum(Pool& pool, std::span<const Term> terms, bool vector);
Expr product(Pool& pool, std::span<const Expr> factors, std::span<const int> exponents);
// A product without one power of its i-th factor. Plain division does not open named products; this does.
Expr without_factor(Expr product, std::size_t i);
Expr zero_vector(Pool& pool);
Expr operator+(Expr a, Expr b);
Expr operator-(Expr a, Expr b);
Expr operator-(Expr a);
Expr operator*(Expr a, Expr b);  // scalar * scalar, scalar * vector, vector * scalar
Expr operator*(Rational c, Expr e);
Expr pow(Expr base, int exponent);  // negative: guarded inverse
Expr operator/(Expr a, Expr b);     // a scalar or vector, b scalar
Expr dot(Expr u, Expr v);
// Two vectors: a scalar in the plane, a vector in space. Plane, scalar and vector: w x v = w perp(v).
Expr cross(Expr u, Expr v);
Expr perp(Expr u);           // in the plane
Expr apply(Expr T, Expr u);  // in the plane T is a number; in space the leaf of a symmetric tensor
// The angle by which g is twisted against f about their x axes: atan2(f_z . g_y - f_y . g_z, f_y . g_y + f_z . g_z).
Expr twist(const Triad& f, const Triad& g);
Expr twist_as_atan2(Expr twist);
Expr norm(Expr u);
Expr unit(Expr u);
Expr call(Fn fn, std::span<const Expr> args);
inline Expr call(Fn fn, Expr a) { return call(fn, std::span<const Expr>(&a, 1)); }
// The world's axes, unit vectors: two in the plane (the y axis is perp of the x axis), three in space.
Expr world_x(Pool& pool);
std::vector<Expr> world_axes(Pool& pool);
inline bool is_world_axis(Expr e) { return e->kind == Kind::symbol && e->symbol.starts_with("world."); }
// An axis of the world (in the plane y is perp of x): products with these are components and stay so.
inline bool is_component_axis(Expr v) { return is_world_axis(v->kind == Kind::perp ? v->args[0] : v); }
// A leaf that stands for a tensor: an inverse inertia in space. Its six components are leaves as well.
bool is_tensor(Expr leaf);
// Components along the world's axes; a scalar is its only one.
std::vector<Expr> components_of(Expr e);

// Same kind of node with other operands: the builders decide anew. `args` has as many entries as e->args.
Expr rebuild(Expr e, std::span<const Expr> args);
// Replaces leaves (or any nodes) bottom-up. Names are kept where the replaced leaves mean the same in other terms (an
// arm by its rotated local vector), and dropped where they do not (velocities by zero).
enum class KeepNames { yes, no };
Expr substitute(Expr e, const std::map<const Node*, Expr>& replacements, KeepNames names = KeepNames::yes);

// Every node that e depends on, operands before users, in an order fixed by structure.
std::vector<Expr> topological(std::span<const Expr> roots);
// Every leaf of them, in the order of their names.
std::vector<Expr> leaves_of(std::span<const Expr> expressions);
bool depends_on_velocity(Expr e);
bool depends_on_bodies(Expr e);

// Infix text in the spec language's notation; a named node prints as its name unless it is e itself.
std::string text(Expr e);
std::string text_unnamed(Expr e);  // names inside e ignored

}  // namespace cdot::derive
