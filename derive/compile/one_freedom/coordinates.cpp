#include "derive/compile/one_freedom/coordinates.hpp"

#include <algorithm>
#include <set>
#include <string>

#include "derive/kernel/factor.hpp"
#include "derive/program/print.hpp"

namespace cdot::compile {
namespace {

using derive::element;

// Which component each row gives, and which angles are to be given first.
class Plan {
 public:
  Plan(std::vector<Component> components, std::vector<std::vector<std::optional<double>>> J,
       std::vector<std::set<std::size_t>> reads, std::set<std::size_t> kept)
      : J_(std::move(J)), reads_(std::move(reads)), kept_(std::move(kept)), is_known_(components.size(), false) {
    out_.components = std::move(components);
    rows_left_.resize(J_.size());
    for (std::size_t row = 0; row < rows_left_.size(); ++row) rows_left_[row] = row;
  }

  std::optional<FewCoordinates> make() {
    while (!rows_left_.empty()) {
      if (take_row()) continue;
      const std::optional<std::size_t> angle = next_angle();
      if (!angle || out_.angles.size() == FewCoordinates::most) return std::nullopt;
      out_.angles.push_back(*angle), is_known_[*angle] = true;
    }
    const bool all = std::ranges::all_of(is_known_, [](bool known) { return known; });
    if (!all || out_.angles.size() != out_.loops.size() + 1) return std::nullopt;
    return std::move(out_);
  }

 private:
  std::vector<std::size_t> unknown_of(std::size_t row) const {
    std::vector<std::size_t> unknown;
    std::ranges::copy_if(reads_[row], std::back_inserter(unknown), [&](std::size_t c) { return !is_known_[c]; });
    return unknown;
  }

  // A row without an unknown closes a loop; one with one unknown gives it.
  bool take_row() {
    for (auto row = rows_left_.begin(); row != rows_left_.end(); ++row) {
      const std::vector<std::size_t> unknown = unknown_of(*row);
      if (unknown.size() > 1) continue;
      if (unknown.empty()) {
        out_.loops.push_back(*row);
      } else {
        const std::optional<double>& coefficient = J_[*row][unknown[0]];
        if (!coefficient || *coefficient == 0 || kept_.contains(unknown[0])) continue;
        out_.eliminated.push_back({*row, unknown[0], *coefficient});
        is_known_[unknown[0]] = true;
      }
      rows_left_.erase(row);
      return true;
    }
    return false;
  }

  // That of the row with the fewest unknowns.
  std::optional<std::size_t> next_angle() const {
    std::optional<std::size_t> angle;
    std::size_t fewest = out_.components.size() + 1;
    for (const std::size_t row : rows_left_) {
      const std::vector<std::size_t> unknown = unknown_of(row);
      const auto first = std::ranges::find_if(unknown, [&](std::size_t c) { return out_.components[c].column == 2; });
      if (first != unknown.end() && unknown.size() < fewest) fewest = unknown.size(), angle = *first;
    }
    return angle;
  }

  std::vector<std::vector<std::optional<double>>> J_;  // constants
  std::vector<std::set<std::size_t>> reads_;           // components, by row
  std::set<std::size_t> kept_;                         // components that no row may give
  std::vector<bool> is_known_;
  std::vector<std::size_t> rows_left_;
  FewCoordinates out_;
};

std::vector<Component> components_of(const RowBlocks& blocks) {
  std::vector<Component> components;
  each_component(blocks, [&](const Component& c, double, double) { components.push_back(c); });
  return components;
}

bool is_simple(const RowBlocks& blocks, const RowSystem& system) {
  const auto holds = [](const RowBlock& block) {
    const bool moves_in_time = block.rows->has_rates || block.in_time != nullptr;
    return !moves_in_time && block.motor == nullptr && block.holds < 0;
  };
  const auto turns = [](const Body& body) { return !body.moves || (body.inv_m > 0 && body.inv_I > 0); };
  return !blocks.mechanism().spatial() && std::ranges::all_of(system.blocks(), holds) &&
         std::ranges::all_of(blocks.mechanism().bodies, turns);
}

// Angles whose sines a row reads.
std::set<std::size_t> turning_angles(const std::vector<Component>& components, const JointRows& joints,
                                     const Columns& J, Algebra& algebra) {
  const std::vector<int> errors = joints.errors(algebra);
  for (std::size_t row = 0; row < errors.size(); ++row) {
    algebra.output(element("C", row), errors[row]);
    for (std::size_t c = 0; c < components.size(); ++c)
      if (J[row][c] >= 0) algebra.output(element(element("J", row), c), J[row][c]);
  }
  const std::set<std::string> read = derive::inputs_read(algebra.finish_as_kernels(), {});
  std::set<std::size_t> angles;
  for (std::size_t c = 0; c < components.size(); ++c) {
    const std::string pose = components[c].in("q");
    const std::string body = pose.substr(0, pose.rfind('.'));
    if (components[c].column == 2 && (read.contains(body + ".c") || read.contains(body + ".s"))) angles.insert(c);
  }
  return angles;
}

}  // namespace

Columns jacobian_of(const RowBlocks& blocks, const RowSystem& system, Algebra& algebra) {
  const std::vector<Component> components = components_of(blocks);
  const std::size_t columns = blocks.mechanism().columns();
  Columns J(system.size(), std::vector<int>(components.size(), -1));
  for (std::size_t k = 0; k < system.blocks().size(); ++k) {
    const RowBlock& block = system.blocks()[k];
    const Values D = blocks.call(algebra, block, "dense", blocks.inputs_with_jacobian(algebra, block));
    for (std::size_t r = 0; r < block.rows->count(); ++r)
      for (std::size_t c = 0; c < components.size(); ++c) {
        Summands terms;
        for (std::size_t b = 0; b < block.bodies->size(); ++b)
          if ((*block.bodies)[b] == components[c].body)
            terms.add(1, D.at(element(element("D", r), columns * b + components[c].column)));
        const int entry = algebra.sum(terms);
        if (!algebra.is_zero(entry)) J[system.first_row(k) + r][c] = entry;
      }
  }
  return J;
}

std::optional<FewCoordinates> few_coordinates(const RowBlocks& blocks, const JointRows& joints, Constants& constants) {
  if (!is_simple(blocks, joints.system())) return std::nullopt;
  const std::vector<Component> components = components_of(blocks);
  if (components.size() != joints.system().size() + 1) return std::nullopt;
  Algebra algebra(constants);
  const Columns J = jacobian_of(blocks, joints.system(), algebra);
  std::vector<std::vector<std::optional<double>>> coefficients(J.size());
  std::vector<std::set<std::size_t>> reads(J.size());
  for (std::size_t row = 0; row < J.size(); ++row)
    for (std::size_t c = 0; c < components.size(); ++c) {
      coefficients[row].push_back(J[row][c] >= 0 ? algebra.constant(J[row][c]) : std::optional(0.0));
      if (J[row][c] >= 0) reads[row].insert(c);
    }
  return Plan(components, coefficients, reads, turning_angles(components, joints, J, algebra)).make();
}

}  // namespace cdot::compile
