// A scene or a CSV file -> a reference trajectory with its resolution; trajectories -> errors.
#include "runtime/tool/accuracy/reference.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <sstream>

#include "runtime/diagnose/concerns.hpp"
#include "runtime/tool/accuracy/refine.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

std::string settled_text(const Refined& method) {
  if (!method.found()) return method.name + " does not converge";
  return fmt::format("{} {} {:.1e}", method.name, method.at_its_floor ? "stagnates at" : "still changes by",
                     method.change());
}

// The reference from two methods, with their disagreement.
ReferenceRun pair_of(const Refined& first, const Refined& second, const std::vector<double>& times,
                     Dimension dimension) {
  ReferenceRun reference;
  reference.times = times;
  reference.made_by = first.name + " and " + second.name + (first.way.extended ? ", in extended precision" : "");
  reference.settled = settled_text(first) + ", " + settled_text(second);
  reference.frames = first.change() <= second.change() ? first.best.frames : second.best.frames;
  reference.disagree.assign(times.size(), std::numeric_limits<double>::infinity());
  if (!first.found() || !second.found()) return reference;
  reference.disagree = distances(first.best.frames, second.best.frames, dimension);
  for (const Refined* method : {&first, &second})
    for (std::size_t k = 0; method->at_its_floor && k < times.size(); ++k)
      reference.disagree[k] = std::max(reference.disagree[k], method->changes[k]);
  return reference;
}

// Of places, angles, speeds and spins, each relative to the largest in the motion.
Perturbation perturbation_of(double share, const ReferenceRun& reference, unsigned seed) {
  Perturbation perturbation{0, 1, 0, 0, seed};
  for (const Frame& frame : reference.frames)
    for (const BodyState& b : frame.bodies) {
      perturbation.position = std::max(perturbation.position, std::hypot(b.x, b.y, b.z));
      perturbation.angle = std::max(perturbation.angle, std::abs(b.angle));
      perturbation.speed = std::max(perturbation.speed, std::hypot(b.vx, b.vy, b.vz));
      perturbation.spin = std::max(perturbation.spin, std::hypot(b.w, b.wx, std::hypot(b.wy, b.wz)));
    }
  perturbation.position *= share, perturbation.angle *= share, perturbation.speed *= share, perturbation.spin *= share;
  return perturbation;
}

Sensitivity sensitivity_of(const Scene& scene, const ReferenceRun& reference, const Refined& method, const Stop& stop) {
  constexpr int starts = 3;  // of each kind
  const auto growth = [&](double share) {
    double worst = 0;
    for (unsigned seed = 0; seed < starts; ++seed) {
      const Trajectory beside =
          trajectory_of(scene, method.way, method.knob, reference.times, stop, perturbation_of(share, reference, seed));
      worst = std::max(worst, largest(distances(beside.frames, method.best.frames, scene.dimension)));
    }
    return worst;
  };
  const double condition = growth(1e-9) / 1e-9;
  if (!method.way.extended) return {condition, growth(1e-15), 1e-15};
  // A start cannot differ by the round-off of extended precision: the growth of larger changes stands for it.
  constexpr double slight = by_precision<long double>(1e-15);
  return {condition, condition * slight, slight};
}

// The CPU time for three methods.
class Budget {
 public:
  explicit Budget(const Effort& each) : each_(each), start_(cpu_now()) {}
  // The share of the next method, when `to_come` are left.
  Effort share(int to_come) const {
    const double left = 3 * each_.cpu - (cpu_now() - start_);
    return {each_.evaluations, std::min(each_.cpu, left / to_come)};
  }

 private:
  Effort each_;
  double start_;
};

// Three methods that share little: the highest order on accelerations, a symmetric method on impulses, and another
// order on accelerations. An implicit one leaves errors of its Newton.
constexpr bool on_accelerations(const IntegratorRow& row) {
  return row.level == Level::acceleration && row.stable_radians < always;
}
constexpr Integrator first_method = most_exact(on_accelerations);
constexpr Integrator second_method = most_exact([](const IntegratorRow& row) { return row.symmetric; });
constexpr Integrator third_method =
    most_exact([](const IntegratorRow& row) { return on_accelerations(row) && row.integrator != first_method; });

// Runs methods in one precision, and finds the two that agree best.
class Comparison {
 public:
  Comparison(const Scene& scene, const std::vector<double>& times, bool extended, const Stop& stop)
      : scene_(scene), times_(times), extended_(extended), stop_(stop) {}

  void ask(Integrator integrator, const Effort& effort) {
    Refined method = refined(integrator, extended_, scene_, times_, effort, stop_);
    for (const Refined& other : methods_) {
      const ReferenceRun pair = pair_of(other, method, times_, scene_.dimension);
      if (!best_.frames.empty() && pair.disagreement() >= best_.disagreement()) continue;
      best_ = pair;
      finer_would_help_ = !other.at_its_floor || !method.at_its_floor;
    }
    methods_.push_back(std::move(method));
  }
  // The first two share no formula but the kernels. Where the motion is not reversible, the third replaces the second.
  void ask_two(const Budget& budget) {
    ask(first_method, budget.share(3));
    Effort effort = budget.share(2);
    if (!reversible(scene_)) return ask(third_method, effort);
    // The second needs about as many steps as the first has evaluations. More would not help.
    effort.evaluations = std::min(effort.evaluations, 5 * first().evaluations);
    ask(second_method, effort);
  }
  bool agrees() const { return best_.disagreement() <= wanted_agreement; }
  // By a margin above chance.
  bool better_than(const Comparison& other) const { return 2 * best_.disagreement() < other.best_.disagreement(); }
  bool finer_would_help() const { return finer_would_help_; }
  const Refined& first() const { return methods_.front(); }
  ReferenceRun& best() { return best_; }

 private:
  const Scene& scene_;
  const std::vector<double>& times_;
  bool extended_;
  const Stop& stop_;
  std::vector<Refined> methods_;
  ReferenceRun best_;
  bool finer_would_help_ = false;
};

}  // namespace

std::string verdict_on(double disagreement, const Sensitivity& sensitivity, bool finer_would_help) {
  // Disagreement up to this multiple of the start's round-off is explained by it: methods round in thousands of steps.
  constexpr double explained = 30;
  if (disagreement <= explained * sensitivity.round_off) return "round-off sets this limit";
  if (finer_would_help) return "the methods need finer steps: raise --budget";
  return "finer steps do not help: the motion magnifies round-off, as near a bifurcation";
}

double ReferenceRun::disagreement() const { return largest(disagree); }
double ReferenceRun::resolution() const { return 10 * disagreement(); }

double ReferenceRun::agreed_until(double bound) const {
  double until = 0;
  for (std::size_t k = 0; k < disagree.size() && disagree[k] <= bound; ++k) until = times[k];
  return until;
}

// Two methods in doubles; if they disagree, the same in extended precision; if they still disagree, a third in the
// better precision.
ReferenceRun make_reference_run(const Scene& scene, const Effort& effort, const Stop& stop) {
  const std::vector<double> times = equal_times(scene.duration, sample_count);
  const Budget budget(effort);
  Comparison doubles(scene, times, false, stop), extended(scene, times, true, stop);
  for (Comparison* comparison : {&doubles, &extended}) {
    comparison->ask_two(budget);
    if (comparison->agrees()) return comparison->best();
  }
  Comparison& better = extended.better_than(doubles) ? extended : doubles;
  if (reversible(scene)) better.ask(third_method, budget.share(1));
  ReferenceRun& best = better.best();
  if (better.agrees() || !better.first().found()) return best;
  best.sensitivity = sensitivity_of(scene, best, better.first(), stop);
  best.verdict = verdict_on(best.disagreement(), best.sensitivity, better.finer_would_help());
  return best;
}

Errors errors_of(const Trajectory& trajectory, const ReferenceRun& reference, const Scene& scene) {
  Errors errors;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t k = 0; k < trajectory.frames.size(); ++k) {
    const Apart here = apart(trajectory.frames[k], reference.frames[k], scene.dimension);
    const double energy = reference.frames[k].energy;
    errors.position = std::max(errors.position, here.position);
    errors.angle = std::max(errors.angle, here.angle);
    errors.energy = std::max(errors.energy, std::abs(trajectory.frames[k].energy - energy));
    least = std::min(least, energy), most = std::max(most, energy);
  }
  // The energy of the reference is known between its samples only if it is constant.
  const double swing = std::max(trajectory.most_energy - least, most - trajectory.least_energy);
  if (reversible(scene) && most - least <= 1e-3 * swing) errors.energy = std::max(errors.energy, swing);
  errors.C = trajectory.C;
  errors.Cdot = trajectory.Cdot;
  return errors;
}

double size_of(const ReferenceRun& reference) {
  double size = 1;
  for (const Frame& frame : reference.frames)
    for (const BodyState& a : frame.bodies)
      for (const BodyState& b : reference.frames.front().bodies)
        size = std::max(size, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
  return size;
}

namespace {

// --- A reference from a file of `cdot-run simulate -o`.

struct Row {
  double time;
  std::vector<double> numbers;
};

std::vector<Row> read_rows(const std::string& path, std::istream& file, std::size_t columns) {
  std::vector<Row> rows;
  int line_number = 1;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    std::vector<double> numbers;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      double number = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
      if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(number))
        throw Error(fmt::format("{}:{}: \"{}\" is not a finite number", path, line_number, cell));
      numbers.push_back(number);
    }
    if (numbers.size() != columns)
      throw Error(fmt::format("{}:{}: {} numbers, but {} columns", path, line_number, numbers.size(), columns));
    if (!rows.empty() && numbers[0] <= rows.back().time)
      throw Error(fmt::format("{}:{}: the times do not ascend", path, line_number));
    rows.push_back({numbers[0], {numbers.begin() + 1, numbers.end()}});
  }
  return rows;
}

// The rows nearest to equal times, each once: at most sample_count, none at the start or beyond the duration.
std::vector<Row> samples_of(const std::vector<Row>& rows, double duration) {
  std::vector<const Row*> usable;
  for (const Row& row : rows)
    if (row.time > 0 && row.time <= duration * (1 + 1e-12)) usable.push_back(&row);
  std::vector<Row> samples;
  if (usable.empty()) return samples;
  for (const double time : equal_times(usable.back()->time, sample_count)) {
    const Row* nearest = usable.front();
    for (const Row* row : usable)
      if (std::abs(row->time - time) < std::abs(nearest->time - time)) nearest = row;
    if (samples.empty() || samples.back().time < nearest->time) samples.push_back(*nearest);
  }
  return samples;
}

// The file has no energies: a World in each of its states gives them.
template <class S>
double energy_of(BasicWorld<S>& world, const Frame& frame) {
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const BodyState& b = frame.bodies[k];
    const int body = static_cast<int>(k);
    if (world.is_static(body)) continue;
    if constexpr (S::dimension == Dimension::planar) {
      world.set_velocity(body, {b.vx, b.vy, b.w});
      world.set_pose(body, {b.x, b.y, b.angle});
    } else {
      world.set_velocity(body, {b.vx, b.vy, b.vz, b.wx, b.wy, b.wz});
      world.set_pose(body, {b.x, b.y, b.z, b.e0, b.e1, b.e2, b.e3});
    }
  }
  return world.energy();
}

template <class S>
ReferenceRun reference_of(const std::vector<Row>& samples, const Scene& scene) {
  ReferenceRun reference;
  std::string warnings;
  BasicWorld<S> world = world_at_start<S>(scene, warnings);
  for (const Row& row : samples) {
    Frame frame;
    frame.time = row.time;
    frame.bodies.resize(scene.bodies.size());
    auto number = row.numbers.begin();
    for (BodyState& body : frame.bodies)
      for (const StateColumn& column : state_columns(S::dimension)) body.*column.number = *number++;
    frame.energy = energy_of(world, frame);
    reference.times.push_back(row.time);
    reference.frames.push_back(frame);
  }
  return reference;
}

}  // namespace

ReferenceRun read_reference_run(const std::string& path, const Scene& scene) {
  std::ifstream file(path, std::ios::binary);
  std::string head;
  if (!std::getline(file, head)) throw Error(path + ": cannot be read");
  const std::string expected = csv_head(scene);
  if (head + "\n" != expected)
    throw Error(fmt::format("{}:1: the columns differ from those of this scene: {}", path,
                            expected.substr(0, expected.size() - 1)));
  const auto columns = static_cast<std::size_t>(std::count(head.begin(), head.end(), ',')) + 1;
  const std::vector<Row> samples = samples_of(read_rows(path, file, columns), scene.duration);
  if (samples.empty()) throw Error(fmt::format("{}: no row between 0 and {} s", path, scene.duration));
  ReferenceRun reference = in_space_of<double>(scene, [&]<class S>(S) { return reference_of<S>(samples, scene); });
  reference.made_by = path;
  return reference;
}

}  // namespace cdot
