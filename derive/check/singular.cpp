// Poses with C = 0 at which K is singular, by search: Newton's method moves random poses with C = 0 to where a
// candidate vanishes as well, or to where the rows of J depend on each other, and the kernel's own numbers decide
// there.
#include <algorithm>
#include <cmath>

#include "derive/check/mass.hpp"
#include "derive/check/zeros.hpp"
#include "derive/numbers/newton.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t starts = 3;   // with the spec's defaults, and as many others
constexpr double dependent = 1e-5;  // share of a row that is no combination of the rows before it
constexpr double guarded = 1e-9;    // a divisor or a length below counts as 0, for which kernels have guards
constexpr std::size_t most_conditions = 2;
constexpr double most_work = 2e7;  // evaluated nodes

class Search {
 public:
  Search(const Subject& subject, std::vector<Freedom> freedoms)
      : subject_(subject),
        freedoms_(std::move(freedoms)),
        found_(freedoms_.size()),
        candidates_(candidates_for_zero(subject)) {
    for (const ScalarRow& row : subject.block.rows) {
      if (row.kind != RowKind::velocity) C_.push_back(row.C);
    }
    J_ = columns_of(subject.block.rows);
    for (const std::vector<Expr>& row : J_) work_of_J_ += work_of(row);
    usual_.resize(J_.size());
    for (const Sample& sample : subject.anywhere) {
      const Gradients J = jacobian_at(subject.block, sample);
      for (std::size_t i = 0; i < J.size(); ++i) usual_[i] = std::max(usual_[i], length(J[i]));
    }
    const auto others = subject.on_constraint.begin() + static_cast<std::ptrdiff_t>(subject.by_defaults);
    by_defaults_ = std::min(starts, subject.by_defaults);
    poses_.assign(subject.on_constraint.begin(),
                  subject.on_constraint.begin() + static_cast<std::ptrdiff_t>(by_defaults_));
    poses_.insert(poses_.end(), others,
                  others + std::min<std::ptrdiff_t>(starts, subject.on_constraint.end() - others));
    if (!poses_.empty()) numbers_.emplace(poses_[0], guarded);
  }

  std::vector<Singular> run() {
    if (poses_.empty()) return found_;
    for (std::size_t f = 0; f < freedoms_.size(); ++f) found_[f].where = where_at_starts(f);
    for (const bool only_bodies : {true, false}) {
      for (const Candidate& candidate : candidates_) try_zero(candidate, only_bodies);
      for (std::size_t f = 0; only_bodies && f < freedoms_.size(); ++f) {
        if (found_[f].where == Singular::Where::nowhere) try_anything(f);
      }
    }
    for (Singular& found : found_) found.given_up = given_up();
    return found_;
  }

  // To each freedom the poses to draw, near this one if Newton's method gets from there to them.
  std::vector<Singular> with_poses(const Sample& near) {
    for (std::size_t f = 0; f < freedoms_.size() && !poses_.empty(); ++f) found_[f].poses = poses_near(near, f);
    return found_;
  }

  // The first of these poses that is regular whatever moves; else regular while everything moves.
  std::optional<Sample> regular_among(const std::vector<Sample>& samples) const {
    for (const std::size_t all : {freedoms_.size(), std::size_t(1)}) {
      for (const Sample& sample : samples) {
        bool regular = !poses_.empty();
        for (std::size_t f = 0; f < all; ++f) regular = regular && !is_singular(sample, f);
        if (regular) return sample;
      }
    }
    return {};
  }

  // The zeros at which the kernel takes the x axis for a direction, or 0 for 1/0, and K is singular at some poses.
  std::vector<std::string> guards() {
    std::vector<std::string> names;
    std::vector<Expr> entries;
    for (const auto& row : J_) entries.insert(entries.end(), row.begin(), row.end());
    Zeros zeros(subject_);
    for (const Expr e : topological(entries)) {
      const bool guarded = e->kind == Kind::unit || e->kind == Kind::norm;
      const bool enough = names.size() == most_conditions || poses_.empty() || given_up();
      if (!guarded || enough || !breaks(e)) continue;
      if (zeros.of(e->args[0]).reach == Reach::never) continue;
      const std::string name = zero_text(e->args[0], subject_.joint);
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    return names;
  }

 private:
  static double work_of(const std::vector<Expr>& expressions) {
    return static_cast<double>(topological(expressions).size());
  }
  bool given_up() const { return work_ > most_work; }

  std::vector<Sample> poses_near(const Sample& near, std::size_t f) const {
    const auto singular = [&](const Sample& sample) { return is_singular(sample, f); };
    std::vector<Sample> poses;
    switch (found_[f].where) {
      case Singular::Where::nowhere:
      case Singular::Where::everywhere: break;
      case Singular::Where::other_branch: poses.push_back(*std::ranges::find_if(poses_, singular)); break;
      case Singular::Where::somewhere: {
        std::vector<Sample> starts = {near};
        starts.insert(starts.end(), poses_.begin(), poses_.end());
        for (Sample& start : starts)
          if (poses.empty() && move_to_dependence(C_, start, f)) poses.push_back(start);
        break;
      }
      case Singular::Where::at_zeros:
        for (const Expr zero : vanishing_.at(f)) {
          std::vector<Expr> equations = C_;
          for (const Expr component : components_of(zero)) equations.push_back(component);
          const bool only_bodies = !found_[f].by_parameters;
          poses.push_back(near);
          if (reaches(equations, poses.back(), only_bodies) && singular(poses.back())) continue;
          for (std::size_t i = poses_.size(); i-- > 0;)  // the first that gets there
            if (Sample start = poses_[i]; reaches(equations, start, only_bodies)) poses.back() = start;
        }
    }
    for (Sample& pose : poses) pose = completed(pose, near);
    return poses;
  }

  // Equations such as sin(theta) n = 0 have a branch, theta = pi, that is singular as a whole.
  Singular::Where where_at_starts(std::size_t f) const {
    const auto singular = [&](const Sample& sample) { return is_singular(sample, f); };
    if (std::ranges::all_of(poses_, singular)) return Singular::Where::everywhere;
    if (std::ranges::none_of(poses_, singular)) return Singular::Where::nowhere;
    const bool meant = std::ranges::any_of(std::span(poses_).first(by_defaults_), singular);
    return meant || by_defaults_ == 0 ? Singular::Where::somewhere : Singular::Where::other_branch;
  }

  // The x axis of the world may have any direction in the mechanism, that of one of its vectors too.
  bool breaks(Expr direction) {
    const std::vector<Sample> zeros = moved(components_of(direction->args[0]), true);
    const auto singular = [&](const Sample& sample) { return is_singular(sample, 0); };
    const auto J = J_;
    bool any = false;
    for (const Candidate& candidate : candidates_) {
      if (any || zeros.empty() || !candidate.e->vector || direction->kind != Kind::unit || given_up()) continue;
      const std::map<const Node*, Expr> guard = {{&*direction, unit(candidate.e)}};
      for (auto& row : J_)
        for (Expr& entry : row) entry = substitute(entry, guard, KeepNames::no);
      any = std::ranges::all_of(zeros, singular);
      J_ = J;
      numbers_.emplace(poses_[0], guarded);
    }
    return any || (!zeros.empty() && std::ranges::all_of(zeros, singular));
  }

  // K is singular where the candidate vanishes, if it is so wherever C = 0 and the candidate vanish.
  void try_zero(const Candidate& candidate, bool only_bodies) {
    std::vector<std::size_t> open;
    for (std::size_t f = 0; f < freedoms_.size(); ++f) {
      const Singular& known = found_[f];
      const bool more = known.where == Singular::Where::at_zeros && known.by_parameters != only_bodies;
      if (known.where == Singular::Where::nowhere || (more && known.zeros.size() < most_conditions)) open.push_back(f);
    }
    if (open.empty() || given_up()) return;
    std::vector<Expr> equations = C_;
    for (const Expr component : components_of(candidate.e)) equations.push_back(component);
    const std::vector<Sample> zeros = moved(equations, only_bodies);
    if (zeros.empty() || given_up()) return;
    for (const std::size_t f : open) {
      const auto singular = [&](const Sample& sample) { return is_singular(sample, f); };
      const auto known = [&](const Sample& sample) { return is_known(sample, f); };
      if (!std::ranges::all_of(zeros, singular) || std::ranges::all_of(zeros, known)) continue;
      found_[f].where = Singular::Where::at_zeros;
      found_[f].zeros.push_back(candidate.name + " = 0" + candidate.explained);
      found_[f].by_parameters = !only_bodies;
      found_[f].of_poses |= depends_on_bodies(candidate.e);
      vanishing_[f].push_back(candidate.e);
    }
  }

  void try_anything(std::size_t f) {
    const auto depends = [&](Sample sample) { return !given_up() && move_to_dependence(C_, sample, f); };
    if (std::ranges::any_of(poses_, depends)) found_[f].where = Singular::Where::somewhere;
  }

  // Moves the bodies to where the equations hold and a row of J is a combination of the others, if it gets there.
  bool move_to_dependence(const std::vector<Expr>& equations, Sample& sample, std::size_t f) const {
    const auto values = [&](const Sample& there) {
      std::vector<double> all = values_at(equations, there);
      all.push_back(independence(there, f));
      return all;
    };
    move_to_zero(subject_.joint, values, sample, true);  // near a double zero it stops short
    return length(values_at(equations, sample)) < dependent && is_singular(sample, f);
  }

  std::vector<Sample> moved(const std::vector<Expr>& equations, bool only_bodies) const {
    std::vector<Sample> there;
    for (Sample sample : poses_)
      if (!given_up() && reaches(equations, sample, only_bodies)) there.push_back(sample);
    return there;
  }

  bool reaches(const std::vector<Expr>& equations, Sample& sample, bool only_bodies) const {
    Numbers numbers(poses_[0]);
    const auto values = [&, work = work_of(equations)](const Sample& at) {
      work_ += work;
      numbers.move_to(at);
      return numbers.of(equations);
    };
    return move_to_zero(subject_.joint, values, sample, only_bodies) && in_range(sample);
  }

  bool in_range(const Sample& sample) const {
    return std::ranges::all_of(subject_.joint.parameters, [&](const Parameter& p) {
      const auto value = sample.scalars.find(p.name);
      return value == sample.scalars.end() ||
             (value->second > p.above + dependent && value->second < p.below - dependent);
    });
  }

  bool is_known(const Sample& sample, std::size_t f) const {
    const auto vanishing = vanishing_.find(f);
    return vanishing != vanishing_.end() && std::ranges::any_of(vanishing->second, [&](Expr e) {
             return length(values_at(components_of(e), sample)) < dependent;
           });
  }

  bool is_singular(const Sample& sample, std::size_t f) const { return !(independence(sample, f) > dependent); }

  // The least share of a row of J, in the columns that may move, that is no combination of the rows before it.
  double independence(const Sample& sample, std::size_t f) const {
    Gradients J;
    work_ += work_of_J_;
    numbers_->move_to(sample);
    const std::size_t width = columns_per_body(subject_.joint.dimension);
    const std::size_t linear = static_cast<std::size_t>(subject_.joint.dimension);
    for (const std::vector<Expr>& row : J_) {
      J.push_back(numbers_->of(row));
      for (std::size_t c = 0; c < J.back().size(); ++c)
        if (!freedoms_[f].allowed[2 * (c / width) + (c % width >= linear)]) J.back()[c] = 0;
    }
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < J.size(); ++i) {
      for (int pass = 0; pass < 2; ++pass) {  // again for what cancels
        for (std::size_t k = 0; k < i; ++k) {
          double along = 0;
          for (std::size_t c = 0; c < J[i].size(); ++c) along += J[i][c] * J[k][c];
          for (std::size_t c = 0; c < J[i].size(); ++c) J[i][c] -= along * J[k][c];
        }
      }
      const double rest = length(J[i]);
      least = std::min(least, rest / usual_[i]);
      if (rest == 0) return 0;
      for (double& x : J[i]) x /= rest;
    }
    return least;
  }

  const Subject& subject_;
  std::vector<Freedom> freedoms_;
  std::vector<Singular> found_;
  std::vector<Expr> C_;
  std::vector<std::vector<Expr>> J_;
  std::vector<double> usual_;  // lengths of the rows of J
  std::vector<Sample> poses_;  // with C = 0
  std::size_t by_defaults_ = 0;
  mutable std::optional<Numbers> numbers_;  // those of the kernel, moved from sample to sample
  std::map<std::size_t, std::vector<Expr>> vanishing_;
  const std::vector<Candidate> candidates_;
  double work_of_J_ = 0;
  mutable double work_ = 0;
};

}  // namespace

std::vector<std::string> guards_that_make_singular(const Subject& subject, const Freedom& everything) {
  return Search(subject, {everything}).guards();
}

std::vector<Singular> singular_poses(const Subject& subject, const std::vector<Freedom>& freedoms,
                                     std::vector<PoseToDraw>* drawn) {
  Search search(subject, freedoms);
  const std::vector<Singular> found = search.run();
  if (drawn == nullptr) return found;
  std::vector<Sample> usual = {subject.usual};
  usual.insert(usual.end(), subject.on_constraint.begin(), subject.on_constraint.end());
  const std::optional<Sample> regular = search.regular_among(usual);
  if (regular) drawn->push_back({PoseToDraw::Why::regular, "A regular pose", completed(*regular, subject.usual)});
  return search.with_poses(regular ? drawn->back().pose : subject.usual);
}

}  // namespace cdot::derive
