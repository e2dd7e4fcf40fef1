// What was drawn and what came of it: joints x ways, refusals and limitations by their words.
#pragma once

#include <map>
#include <string>

#include "tests/torture/generate.hpp"
#include "tests/torture/invariants.hpp"

namespace cdot::torture {

std::string way_of(const Scene& scene);  // "direct rattle float"

class Tally {
 public:
  void add(const Mechanism& mechanism, const Verdict& verdict);

  int mechanisms() const { return mechanisms_; }
  int count(Outcome outcome) const;
  // Of how many mechanisms a joint of that space was part.
  int drawn(Dimension dimension, const std::string& joint) const;
  // Tables of all of it.
  std::string text() const;

 private:
  using Counts = std::map<std::string, int>;
  int mechanisms_ = 0, energy_ = 0, momentum_ = 0, left_out_ = 0;
  long long steps_ = 0;
  std::map<Outcome, int> outcomes_;
  std::map<std::pair<Dimension, std::string>, Counts> joints_;  // by way
  Counts ways_, reasons_;
};

}  // namespace cdot::torture
