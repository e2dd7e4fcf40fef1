// The notes on where K is singular.
#include <algorithm>

#include "derive/check/mass.hpp"

namespace cdot::derive {
namespace {

// While only b can move, or while nothing can turn.
std::vector<Freedom> all_freedoms(const Joint& joint) {
  const std::size_t masses = 2 * joint.bodies.size();
  std::vector<Freedom> freedoms = {{"", std::vector<bool>(masses, true)}};
  for (std::size_t b = 0; joint.bodies.size() > 1 && b < joint.bodies.size(); ++b) {
    freedoms.push_back({"only " + joint.bodies[b] + " can move", std::vector<bool>(masses, false)});
    freedoms.back().allowed[2 * b] = freedoms.back().allowed[2 * b + 1] = true;
  }
  freedoms.push_back({"nothing can turn", std::vector<bool>(masses, true)});
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) freedoms.back().allowed[2 * b + 1] = false;
  return freedoms;
}

std::string text_of(const Singular& singular) {
  switch (singular.where) {
    case Singular::Where::nowhere: return "";
    case Singular::Where::everywhere: return "K is singular at every pose";
    case Singular::Where::other_branch: return "K is singular on a branch of C = 0 to which the defaults do not lead";
    case Singular::Where::somewhere: return "K is singular at some poses with C = 0";
    case Singular::Where::at_zeros: break;
  }
  std::string text = "K is singular where ";
  for (const std::string& zero : singular.zeros) text += (&zero == &singular.zeros[0] ? "" : " or ") + zero;
  return text + (singular.by_parameters && singular.of_poses ? ", which some parameters allow" : "");
}

// Its poses, each with the words for its own zero.
void draw(const Singular& singular, const std::string& condition, std::vector<PoseToDraw>& poses) {
  for (std::size_t i = 0; i < singular.poses.size(); ++i) {
    Singular one = singular;
    if (!one.zeros.empty()) one.zeros = {singular.zeros[i]};
    poses.push_back({PoseToDraw::Why::singular, condition + text_of(one), singular.poses[i]});
  }
}

Way way_of(const Movement& movement, const Joint& joint) {
  Way way;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (movement[2 * b] > 0) way.move.insert(joint.bodies[b]);
    if (movement[2 * b + 1] > 0) way.turn.insert(joint.bodies[b]);
  }
  return way;
}

// The least ways to move that keep K regular.
std::vector<Way> least_ways(const std::vector<Movement>& sure, const Joint& joint) {
  std::vector<Way> all, least;
  for (const Movement& movement : sure) all.push_back(way_of(movement, joint));
  for (const Way& way : all) {
    const bool more = std::ranges::any_of(all, [&](const Way& less) {
      return less != way && std::ranges::includes(way.move, less.move) && std::ranges::includes(way.turn, less.turn);
    });
    if (!more && std::ranges::find(least, way) == least.end()) least.push_back(way);
  }
  return least;
}

}  // namespace

void check_mass(const Subject& subject, Findings& findings, std::vector<PoseToDraw>* poses) {
  const auto is_error = [](const Finding& f) { return f.level == Level::error; };
  if (subject.block.rows.empty() || subject.on_constraint.empty() || std::ranges::any_of(findings, is_error)) return;
  const auto add = [&](std::string message) {
    findings.add(Level::note, "singular", subject.joint.rows.front().where, std::move(message));
  };
  const std::vector<Freedom> freedoms = all_freedoms(subject.joint);
  const std::vector<Singular> singular = singular_poses(subject, freedoms, poses);
  const std::string always = text_of(singular[0]);
  if (always.empty()) {
    const std::vector<Movement> sure = proved_regular(subject);
    std::string but;
    for (const std::string& guard : guards_that_make_singular(subject, freedoms[0]))
      but += (but.empty() ? ", but may be singular where " : " or ") + guard + " = 0";
    add((sure.empty() ? "K is regular at every pose with C = 0 that was tried"
                      : "K is regular at every pose while " + in_words(least_ways(sure, subject.joint))) +
        but);
  } else {
    add(always);
    if (poses != nullptr) draw(singular[0], "", *poses);
  }
  std::vector<std::string> told = {always, ""};
  for (std::size_t f = 1; f < freedoms.size(); ++f) {
    const std::string text = text_of(singular[f]);
    if (std::ranges::find(told, text) != told.end()) continue;
    told.push_back(text);
    std::string conditions = freedoms[f].condition;
    for (std::size_t other = f + 1; other < freedoms.size(); ++other)
      if (text_of(singular[other]) == text) conditions += " or " + freedoms[other].condition;
    add("while " + conditions + ", " + text);
    if (poses != nullptr) draw(singular[f], "while " + conditions + ", ", *poses);
  }
  if (singular[0].given_up) add("the search for poses at which K is singular was given up: too long");
}

}  // namespace cdot::derive
