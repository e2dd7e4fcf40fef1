#include "derive/compile/one_freedom/programs.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;

using Numbers = std::vector<int>;

class FreedomWriter {
 public:
  FreedomWriter(const RowBlocks& blocks, const JointRows& joints, Constants& constants, FewCoordinates few)
      : blocks_(blocks), joints_(joints), constants_(constants), few_(std::move(few)) {}

  FreedomPrograms write() {
    for (const std::size_t angle : few_.angles) out_.angles.push_back(blocks_.body_name(few_.components[angle].body));
    out_.find_tangent = find_tangent();
    out_.go_along = go_along();
    out_.find_impulses = find_impulses();
    out_.place = place();
    out_.aim_angles = aim_angles();
    return std::move(out_);
  }

 private:
  std::size_t count() const { return few_.angles.size(); }
  const Component& component(std::size_t c) const { return few_.components[c]; }

  // M a of a component.
  int momentum(Algebra& algebra, std::size_t c, int a) const {
    return blocks_.momentum(algebra, component(c).body, component(c).column, [&](std::size_t) { return a; });
  }

  int dot(Algebra& algebra, const Numbers& x, const Numbers& y, const std::string& name = {}) const {
    Summands terms;
    for (std::size_t i = 0; i < x.size(); ++i) terms.add(1, algebra.times(x[i], y[i]));
    return algebra.sum(terms, name);
  }

  // x^T M y, by components.
  int weighed(Algebra& algebra, const Numbers& x, const Numbers& y, const std::string& name = {}) const {
    Numbers My;
    for (std::size_t c = 0; c < y.size(); ++c) My.push_back(momentum(algebra, c, y[c]));
    return dot(algebra, x, My, name);
  }

  // J E of a row, by the angle k; of components that do not follow yet E is 0.
  int slope(Algebra& algebra, const Numbers& row, const Columns& E, std::size_t k) const {
    Summands terms;
    for (std::size_t c = 0; c < E.size(); ++c)
      if (row[c] >= 0) terms.add(1, algebra.times(row[c], E[c][k]));
    return algebra.sum(terms);
  }

  static Numbers column(const Columns& E, std::size_t k) {
    Numbers column;
    for (const Numbers& of_component : E) column.push_back(of_component[k]);
    return column;
  }

  // E = dq/du at the pose, by components.
  Columns slopes(Algebra& algebra, const Columns& J) const {
    Columns E(few_.components.size(), Numbers(count(), algebra.value(0)));
    for (std::size_t k = 0; k < count(); ++k) {
      E[few_.angles[k]][k] = algebra.value(1);
      for (const auto& [row, component, coefficient] : few_.eliminated)
        E[component][k] = algebra.times(algebra.value(-1 / coefficient), slope(algebra, J[row], E, k));
    }
    return E;
  }

  // c' = J E of the loops.
  Columns loops(Algebra& algebra, const Columns& J, const Columns& E) const {
    Columns slopes;
    for (const std::size_t row : few_.loops) {
      slopes.emplace_back();
      for (std::size_t k = 0; k < count(); ++k) slopes.back().push_back(slope(algebra, J[row], E, k));
    }
    return slopes;
  }

  // x x y; of two numbers, the one that is normal to x.
  Numbers cross(Algebra& algebra, const Numbers& x, const Numbers& y) const {
    const auto minor = [&](std::size_t i, std::size_t j) {
      return algebra.sum({{algebra.times(x[i], y[j]), algebra.times(x[j], y[i])}, {1, -1}});
    };
    return {minor(1, 2), minor(2, 0), minor(0, 1)};
  }
  Numbers normal(Algebra& algebra, const Numbers& x) const { return {algebra.sum({{x[1]}, {-1}}), x[0]}; }

  // t_u, normal to the slopes of the loops.
  Numbers direction(Algebra& algebra, const Columns& slopes) const {
    if (count() == 1) return {algebra.value(1)};
    return count() == 2 ? normal(algebra, slopes[0]) : cross(algebra, slopes[0], slopes[1]);
  }

  // The columns of A^-1 but the last one, t_u, times the determinant of A = (c'; b).
  Columns inverse(Algebra& algebra, const Columns& slopes, const Numbers& b) const {
    if (count() == 1) return {};
    if (count() == 3) return {cross(algebra, slopes[1], b), cross(algebra, b, slopes[0])};
    return {{b[1], algebra.sum({{b[0]}, {-1}})}};
  }

  // w t^T M E
  Numbers last_row(Algebra& algebra, const Numbers& t, int w, const Columns& E) const {
    Numbers b;
    for (std::size_t k = 0; k < count(); ++k) b.push_back(algebra.times(w, weighed(algebra, column(E, k), t)));
    return b;
  }

  void store(Algebra& algebra, const std::string& name, int op) {
    constant_[name] = algebra.constant(op);
    if (constant_[name]) return;
    algebra.output("F." + name, op);
    constants_.at_start["F." + name] = algebra.at_start(op);
    out_.stored.push_back(name);
  }
  int stored(Algebra& algebra, const std::string& name) const {
    const std::optional<double>& constant = constant_.at(name);
    return constant ? algebra.value(*constant) : algebra.input("F." + name);
  }
  std::string of_component(std::size_t c) const {
    std::string name = component(c).name;
    return name.replace(name.rfind('.'), 1, "_");
  }
  static std::string of_inverse(std::size_t column, std::size_t k) { return fmt::format("inverse_{}_{}", k, column); }
  Numbers tangents(Algebra& algebra) const {
    Numbers t;
    for (std::size_t c = 0; c < few_.components.size(); ++c) t.push_back(stored(algebra, of_component(c)));
    return t;
  }
  Numbers inputs(Algebra& algebra, const std::string& array) const {
    Numbers numbers;
    for (const Component& c : few_.components) numbers.push_back(algebra.input(c.in(array)));
    return numbers;
  }

  Program find_tangent() {
    Algebra algebra(constants_);
    const Columns J = jacobian_of(blocks_, joints_.system(), algebra), E = slopes(algebra, J), c = loops(algebra, J, E);
    const Numbers direction = this->direction(algebra, c);
    Numbers t;
    for (const Numbers& of_component : E) t.push_back(dot(algebra, of_component, direction));
    for (std::size_t i = 0; i < t.size(); ++i) store(algebra, of_component(i), t[i]);
    const int w = algebra.function(Fn::inverse, {weighed(algebra, t, t)}, "w");
    store(algebra, "w", w);
    const Columns columns = inverse(algebra, c, last_row(algebra, t, w, E));
    for (std::size_t j = 0; j < columns.size(); ++j)
      for (std::size_t k = 0; k < count(); ++k) store(algebra, of_inverse(j, k), columns[j][k]);
    return algebra.finish();
  }

  Program go_along() const {
    Algebra algebra(constants_);
    const Numbers t = tangents(algebra);
    const int rate = algebra.times(stored(algebra, "w"), weighed(algebra, t, inputs(algebra, "v"), "momentum"), "rate");
    for (std::size_t c = 0; c < t.size(); ++c) algebra.output(component(c).in("next"), algebra.times(t[c], rate));
    return algebra.finish();
  }

  // First those of the loops, by c'^T lambda = E^T M d; then the others, each by what is left of its component.
  Program find_impulses() const {
    Algebra algebra(constants_);
    const Columns J = jacobian_of(blocks_, joints_.system(), algebra), E = slopes(algebra, J);
    Numbers left;
    const Numbers d = inputs(algebra, "d");
    for (std::size_t c = 0; c < d.size(); ++c) left.push_back(momentum(algebra, c, d[c]));
    Numbers along;
    for (std::size_t k = 0; k < count(); ++k) along.push_back(dot(algebra, column(E, k), left));
    const auto give = [&](std::size_t row, int lambda) {
      algebra.output(element("lambda", row), lambda);
      for (std::size_t c = 0; c < left.size(); ++c)
        if (J[row][c] >= 0) left[c] = algebra.sum({{left[c], algebra.times(J[row][c], lambda)}, {1, -1}});
    };
    for (std::size_t l = 0; l < few_.loops.size(); ++l) {
      Numbers of_loop;
      for (std::size_t k = 0; k < count(); ++k) of_loop.push_back(stored(algebra, of_inverse(l, k)));
      give(few_.loops[l], dot(algebra, of_loop, along, "lambda_of_loop"));
    }
    for (auto one = few_.eliminated.rbegin(); one != few_.eliminated.rend(); ++one)
      give(one->row, algebra.times(algebra.value(1 / one->coefficient), left[one->component]));
    return algebra.finish();
  }

  // C of a row at these places.
  int error(Algebra& algebra, std::size_t row, const Values& places) const {
    const RowSystem& system = joints_.system();
    std::size_t k = system.blocks().size() - 1;
    while (system.first_row(k) > row) --k;
    const RowBlock& block = system.blocks()[k];
    Values in = blocks_.inputs(algebra, block);
    blocks_.replace_places(in, block, places);
    return blocks_.call(algebra, block, "position", in).at(element("C", row - system.first_row(k)));
  }

  // Rows are linear in the components that they give: x = -C(0) / coefficient. Moves of the angles are sums of small
  // turns, since an angle of many turns has a coarse last place.
  Program place() const {
    Algebra algebra(constants_);
    Values places;
    for (const Component& c : few_.components) places[c.name] = algebra.value(0);
    for (const std::size_t angle : few_.angles)
      places[component(angle).name] =
          algebra.input(fmt::format("q[{}].angle", blocks_.body_name(component(angle).body)));
    for (const auto& [row, c, coefficient] : few_.eliminated) {
      const int place = algebra.times(algebra.value(-1 / coefficient), error(algebra, row, places));
      places[component(c).name] = place;
      algebra.output(component(c).column == 2 ? fmt::format("q[{}].angle", blocks_.body_name(component(c).body))
                                              : component(c).in("q"),
                     place);
    }
    Numbers moves;
    for (std::size_t c = 0; c < few_.components.size(); ++c) {
      const Component& component = this->component(c);
      const auto angle = std::ranges::find(few_.angles, c);
      const auto k = static_cast<std::size_t>(angle - few_.angles.begin());
      moves.push_back(angle != few_.angles.end()
                          ? algebra.input(element("found", k))
                          : algebra.sum({{places[component.name], algebra.input(component.in("free"))}, {1, -1}}));
      algebra.output(component.in("moves"), moves.back());
    }
    for (std::size_t l = 0; l < few_.loops.size(); ++l)
      algebra.output(element("missed", l), error(algebra, few_.loops[l], places));
    const int along = algebra.times(stored(algebra, "w"), weighed(algebra, moves, tangents(algebra)), "along");
    algebra.output(element("missed", few_.loops.size()), along);
    Summands squares;
    for (const std::size_t angle : few_.angles)
      squares.add(1, algebra.product({stored(algebra, of_component(angle)), along}, {2, 2}));
    algebra.output("off", algebra.sum(squares));
    return algebra.finish();
  }

  // turn = -A^-1 missed; share^2 = |A_0^-1 A - 1|^2, by which rounds with J of the start would leave of an error.
  Program aim_angles() const {
    Algebra algebra(constants_);
    const Columns J = jacobian_of(blocks_, joints_.system(), algebra), E = slopes(algebra, J), c = loops(algebra, J, E);
    const Numbers direction = this->direction(algebra, c);
    const Numbers b = last_row(algebra, tangents(algebra), stored(algebra, "w"), E);
    const int determinant = algebra.function(Fn::inverse, {dot(algebra, b, direction)}, "inverse_of_A");
    Columns columns = inverse(algebra, c, b);
    columns.push_back(direction);
    for (std::size_t k = 0; k < count(); ++k) {
      Summands terms;
      for (std::size_t j = 0; j < columns.size(); ++j)
        terms.add(-1, algebra.times(columns[j][k], algebra.input(element("missed", j))));
      algebra.output(element("turn", k), algebra.times(determinant, algebra.sum(terms)));
    }
    Summands squares;
    for (std::size_t k = 0; k < count(); ++k)
      for (std::size_t i = 0; i < count(); ++i) {
        Summands entry{{algebra.times(stored(algebra, of_component(few_.angles[k])), b[i])}, {1}};
        for (std::size_t j = 0; j < c.size(); ++j)
          entry.add(1, algebra.times(stored(algebra, of_inverse(j, k)), c[j][i]));
        if (i == k) entry.add(-1, algebra.value(1));
        squares.add(1, algebra.product({algebra.sum(entry)}, {2}));
      }
    algebra.output("share", algebra.sum(squares));
    return algebra.finish();
  }

  const RowBlocks& blocks_;
  const JointRows& joints_;
  Constants& constants_;
  FewCoordinates few_;
  std::map<std::string, std::optional<double>> constant_;  // of the numbers of F
  FreedomPrograms out_;
};

}  // namespace

std::vector<const Program*> programs_of_freedom(const FreedomPrograms& f) {
  return {&f.find_tangent, &f.go_along, &f.find_impulses, &f.place, &f.aim_angles};
}

FreedomPrograms freedom_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  std::optional<FewCoordinates> few = few_coordinates(blocks, joints, constants);
  if (!few) return {};
  return FreedomWriter(blocks, joints, constants, std::move(*few)).write();
}

}  // namespace cdot::compile
