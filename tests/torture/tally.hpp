// Counts of mechanisms and verdicts: joints x ways, refusals and limitations by reason.
#pragma once

#include <map>
#include <string>

#include "tests/torture/draw/generate.hpp"
#include "tests/torture/invariants.hpp"

namespace cdot::torture {

std::string way_of(const Scene& scene);  // "direct rattle float"

class Tally {
 public:
  void add(const Mechanism& mechanism, const Verdict& verdict);

  int mechanisms() const { return mechanisms_; }
  int count(Outcome outcome) const;
  // The number of mechanisms with that joint.
  int drawn(Dimension dimension, const std::string& joint) const;
  std::string outcomes() const;  // "held 1839, limited 160, BROKEN 1"
  std::string text() const;      // all counts as tables

 private:
  using Counts = std::map<std::string, int>;
  int mechanisms_ = 0, energy_ = 0, momentum_ = 0, left_out_ = 0;
  long long steps_ = 0;
  std::map<Outcome, int> outcomes_;
  std::map<std::pair<Dimension, std::string>, Counts> joints_;  // by way
  Counts ways_, reasons_;
};

}  // namespace cdot::torture
