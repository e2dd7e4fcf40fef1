#include "derive/expression/shared.hpp"

namespace cdot::derive {
namespace {

constexpr double short_enough = 4000;       // nodes as written, of all roots together
constexpr double worth_a_name = 6;          // nodes
constexpr double long_part = 9, often = 4;  // nodes of a part that recurs, and its places

// The nodes of e as it is written; a name is one.
double written(Expr e, const std::map<const Node*, double>& sizes) {
  double size = 1;
  for (const Expr arg : e->args) size += sizes.at(&*arg);
  return size;
}

double total(std::span<const Expr> roots, const std::map<const Node*, double>& sizes) {
  double sum = 0;
  for (const Expr root : roots) sum += sizes.at(&*root);
  return sum;
}

// The places of each part where all roots are written out.
std::map<const Node*, double> places(std::span<const Expr> roots, const std::vector<Expr>& order, bool (*named)(Expr)) {
  std::map<const Node*, double> count;
  for (const Expr root : roots) ++count[&*root];
  for (auto e = order.rbegin(); e != order.rend(); ++e) {
    const double here = named(*e) ? 1 : count[&**e];
    for (const Expr arg : (*e)->args) count[&*arg] += here;
  }
  return count;
}

}  // namespace

double written_size(Expr e, bool (*named)(Expr)) {
  std::map<const Node*, double> sizes;
  for (const Expr part : topological(std::span(&e, 1)))
    sizes[&*part] = part != e && named(part) ? 1 : written(part, sizes);
  return sizes.at(&*e);
}

std::vector<Expr> shared_parts(std::span<const Expr> roots, bool (*named)(Expr)) {
  const std::vector<Expr> order = topological(roots);
  std::map<const Node*, double> sizes;
  for (const Expr e : order) sizes[&*e] = named(e) ? 1 : written(e, sizes);
  if (total(roots, sizes) <= short_enough) return {};
  std::map<const Node*, int> uses;
  for (const Expr root : roots) ++uses[&*root];
  for (const Expr e : order) {
    for (const Expr arg : e->args) ++uses[&*arg];
  }
  std::vector<Expr> parts;
  for (const Expr e : order) {
    double& size = sizes[&*e] = named(e) ? 1 : written(e, sizes);
    if (size < worth_a_name || uses[&*e] < 2) continue;
    parts.push_back(e);
    size = 1;
  }
  return parts;
}

std::vector<Expr> recurring_parts(std::span<const Expr> roots, bool (*named)(Expr)) {
  const std::vector<Expr> order = topological(roots);
  std::map<const Node*, double> count = places(roots, order, named), sizes;
  std::vector<Expr> parts;
  for (const Expr e : order) {
    double& size = sizes[&*e] = named(e) ? 1 : written(e, sizes);
    if (size < long_part || count[&*e] < often || depends_on_velocity(e)) continue;
    parts.push_back(e);
    size = 1;
  }
  return parts;
}

}  // namespace cdot::derive
