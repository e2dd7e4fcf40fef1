// The names that other programs see: one for every component that an expression may contain, with what it means.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "derive/language/joint.hpp"
#include "runtime/text/json.hpp"

namespace cdot::derive {

class ExplainedSymbols {
 public:
  explicit ExplainedSymbols(const Joint& joint);

  std::string name(Expr symbol);  // of a scalar leaf; arms are renamed: ra_x is r_pa_x
  // A leaf of the law of an effect: what stands for a row's value or rate, for a mass or a load.
  void add_leaf(Expr leaf, const std::string& wish, const std::string& kind, const std::string& meaning,
                const Unit& unit);
  std::string reserve(const std::string& wish);  // a name that nothing else has, near the wish
  text::Json json() const { return docs_; }
  // Triads among the parameters: name, and three axes of three components each.
  text::Json frames() const { return frames_; }

 private:
  struct Doc {
    std::string kind, meaning, unit, frame, body, from;
    bool unit_length = false;
  };
  void add(const std::string& leaf, const std::string& wish, const Doc& doc);
  void add_body(const std::string& body);
  void add_orientation(const std::string& body);
  void add_components(const std::string& stem, const Doc& doc);
  void add_parameter(const Joint& joint, const Parameter& parameter);
  std::vector<std::string> add_direction(const Joint& joint, const Parameter& parameter, const std::string& leaf,
                                         Doc doc);
  void add_turned(const std::string& leaf, const std::string& wish, const std::vector<std::string>& given,
                  const Doc& doc);
  void add_axis(Expr symbol);

  std::vector<std::string> bodies_;
  std::string letters_;                       // of components: "xy" or "xyz"
  std::map<std::string, std::string> names_;  // of leaves
  std::set<std::string> taken_;
  text::Json docs_ = text::Json::object();
  text::Json frames_ = text::Json::array();
};

}  // namespace cdot::derive
