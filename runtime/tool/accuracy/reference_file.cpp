// A reference from a file, a CSV as `cdot-run simulate -o` writes it. Apart from tool/accuracy/reference.cpp, which
// makes one.
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <sstream>

#include "runtime/tool/accuracy/reference.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

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
        throw Error(fmt::format("{}:{}: \"{}\" is no finite number", path, line_number, cell));
      numbers.push_back(number);
    }
    if (numbers.size() != columns)
      throw Error(fmt::format("{}:{}: {} numbers where the head names {}", path, line_number, numbers.size(), columns));
    if (!rows.empty() && numbers[0] <= rows.back().time)
      throw Error(fmt::format("{}:{}: the times do not ascend", path, line_number));
    rows.push_back({numbers[0], {numbers.begin() + 1, numbers.end()}});
  }
  return rows;
}

// The rows nearest to equal times, each once: at most sample_count of them, none at the start or beyond the duration.
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

// The file has no energies: those of a World that is put into each of its states.
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
    throw Error(fmt::format("{}:1: not the columns of this scene, as `cdot-run simulate -o` writes them: {}", path,
                            expected.substr(0, expected.size() - 1)));
  const auto columns = static_cast<std::size_t>(std::count(head.begin(), head.end(), ',')) + 1;
  const std::vector<Row> samples = samples_of(read_rows(path, file, columns), scene.duration);
  if (samples.empty()) throw Error(fmt::format("{}: no row between 0 and {} s", path, scene.duration));
  ReferenceRun reference = in_space_of<double>(scene, [&]<class S>(S) { return reference_of<S>(samples, scene); });
  reference.made_by = path;
  return reference;
}

}  // namespace cdot
