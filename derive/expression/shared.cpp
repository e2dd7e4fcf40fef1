#include "derive/expression/shared.hpp"

namespace cdot::derive {
namespace {

constexpr double short_enough = 4000;  // nodes as written, of all roots together
constexpr double worth_a_name = 6;     // nodes

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

}  // namespace cdot::derive
