#include "derive/compile/rows/joint_rows.hpp"

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

std::vector<RowBlock> joints_of(const RowBlocks& rows) {
  std::vector<RowBlock> blocks;
  for (std::size_t j = 0; j < rows.mechanism().joints.size(); ++j) blocks.push_back(rows.joint(j));
  return blocks;
}

}  // namespace

JointRows::JointRows(const RowBlocks& blocks)
    : blocks_(blocks), system_(blocks, joints_of(blocks)), J_(system_.blocks().size()) {}

int JointRows::read(Algebra& algebra, const Stored& stored) {
  if (stored.constant) return algebra.value(*stored.constant);
  return algebra.sum({{algebra.input("J." + stored.member)}, {stored.sign}});
}

Program JointRows::evaluate(Constants& constants, std::vector<std::string>& stored) {
  Algebra algebra(constants);
  std::map<std::pair<int, double>, Stored> known;  // by operations without their signs
  const auto store = [&](const std::string& member, int op) {
    if (const std::optional<double> constant = algebra.constant(op)) return Stored{constant, {}};
    const auto [base, factor] = algebra.without_factor(op);
    const int sign = factor.sign();
    const auto [same, is_new] = known.try_emplace({base, derive::abs(factor).value()}, Stored{{}, member, sign});
    if (!is_new) return Stored{{}, same->second.member, sign * same->second.sign};
    algebra.output("J." + member, op), stored.push_back(member);
    constants.at_start["J." + member] = algebra.at_start(op);
    return Stored{{}, member};
  };
  for (std::size_t k = 0; k < J_.size(); ++k) {
    const RowBlock& joint = system_.blocks()[k];
    Values in = blocks_.inputs(algebra, joint);
    const Values J = blocks_.call(algebra, joint, "jacobian", in);
    for (const std::string& field : joint.rows->fields) {
      in["J." + field] = J.at("J." + field);
      J_[k][field] = store(joint.name + "_" + field, in["J." + field]);
    }
    if (joint.holds >= 0) holds_[k] = store(joint.name + "_holds", in.at("holds"));
    const Values C_t =
        joint.rows->has_rates || joint.in_time ? blocks_.call(algebra, joint, "time_derivative", in) : Values{};
    for (std::size_t r = 0, row = system_.first_row(k); r < joint.rows->count(); ++r, ++row) {
      Summands drift;
      if (!C_t.empty()) drift.add(1, C_t.at(derive::element("C_t", r)));
      if (joint.motor && joint.motor->speed_in_time) drift.add(-1, held(algebra, in, blocks_.speed(algebra, joint)));
      if (!drift.args.empty()) rates_[row] = store(system_.names()[row] + "_rate", algebra.sum(drift));
    }
    system_.add_block(algebra, k, in);
  }
  system_.couple(algebra);
  system_.factor(algebra, [&](const std::string& name, int op) { factor_[name] = store(name, op); });
  return algebra.finish();
}

// A number of a joint that may break.
int JointRows::held(Algebra& algebra, const Values& in, int number) {
  const auto holds = in.find("holds");
  return holds == in.end() ? number : algebra.times(holds->second, number);
}

Values JointRows::inputs(Algebra& algebra, std::size_t block) const {
  Values in = blocks_.inputs(algebra, system_.blocks()[block]);
  for (const auto& [field, stored] : J_[block]) in["J." + field] = read(algebra, stored);
  if (const auto holds = holds_.find(block); holds != holds_.end()) in["holds"] = read(algebra, holds->second);
  return in;
}

int JointRows::drift(Algebra& algebra, std::size_t row) const {
  const auto C_t = rates_.find(row);
  return C_t == rates_.end() ? algebra.value(0) : read(algebra, C_t->second);
}

std::vector<int> JointRows::errors(Algebra& algebra) const {
  std::vector<int> errors;
  for (const RowBlock& joint : system_.blocks()) {
    Values C;
    if (!joint.motor) C = blocks_.call(algebra, joint, "position", blocks_.inputs(algebra, joint));
    for (std::size_t r = 0; r < joint.rows->count(); ++r)
      errors.push_back(joint.motor ? algebra.value(0) : C.at(derive::element("C", r)));
  }
  return errors;
}

std::vector<int> JointRows::rates(Algebra& algebra, const Values& velocities) const {
  std::vector<int> rates;
  for (std::size_t k = 0; k < J_.size(); ++k) {
    const RowBlock& joint = system_.blocks()[k];
    Values in = inputs(algebra, k);
    blocks_.replace_velocities(in, joint, velocities);
    const Values Jv = blocks_.call(algebra, joint, "velocity", in);
    for (std::size_t r = 0; r < joint.rows->count(); ++r) {
      Summands rate{{Jv.at(derive::element("Jv", r)), drift(algebra, rates.size())}, {1, 1}};
      if (joint.motor && !joint.motor->speed_in_time) rate.add(-1, held(algebra, in, blocks_.speed(algebra, joint)));
      rates.push_back(algebra.sum(rate));
    }
  }
  return rates;
}

}  // namespace cdot::compile
