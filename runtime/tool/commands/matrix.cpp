#include "runtime/tool/commands/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cdot {
namespace {

// Beyond this many columns or rows numbers are no longer for reading.
constexpr int most_columns = 60, most_rows = 60, most_bodies = 12;

// A cosine of a quarter turn reads 0, not 6e-17; all digits are in the JSON.
double without_round_off(double entry) { return std::fabs(entry) < 1e-15 ? 0.0 : entry; }

const SceneJoint& source_of(const Scene& scene, const SystemMatrix::Joint& joint) {
  return scene.joints[static_cast<std::size_t>(joint.joint)];
}

const std::string& body_name(const Scene& scene, const SystemMatrix& system, int at) {
  static const std::string ground = "world";
  const auto body = static_cast<std::size_t>(system.bodies[static_cast<std::size_t>(at)]);
  return body < scene.bodies.size() ? scene.bodies[body].name : ground;
}

std::string plural(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

int entries_of_K(const SystemMatrix& system) {
  return static_cast<int>(std::count_if(system.K.begin(), system.K.end(), [](double x) { return x != 0; }));
}

std::size_t joint_width(const Scene& scene, const SystemMatrix& system) {
  std::size_t width = 5;
  for (const auto& joint : system.joints) width = std::max(width, source_of(scene, joint).name.size());
  return width;
}

// One line per joint: a block of rows x columns where it holds a body.
std::string blocks_text(const Scene& scene, const SystemMatrix& system) {
  const std::size_t name_width = joint_width(scene, system);
  std::size_t width = 6;
  const int bodies = static_cast<int>(system.bodies.size());
  for (int k = 0; k < bodies; ++k) width = std::max(width, body_name(scene, system, k).size() + 2);
  std::string text = fmt::format("  {:{}}  rows ", "joint", name_width);
  for (int k = 0; k < bodies; ++k) text += fmt::format("{:>{}}", body_name(scene, system, k), width);
  for (const auto& joint : system.joints) {
    const SceneJoint& source = source_of(scene, joint);
    text += fmt::format("\n  {:{}}  {:4} ", source.name, name_width, joint.rows);
    for (int k = 0; k < bodies; ++k) {
      const bool empty = system.empty_block(joint, k);
      text += fmt::format("{:>{}}", empty ? "." : fmt::format("{}x{}", joint.rows, system.freedom), width);
    }
    text += "  " + source.definition.type;
  }
  return text + "\n";
}

// The same where a column per body would be too wide: the bodies by name.
std::string list_text(const Scene& scene, const SystemMatrix& system) {
  const std::size_t name_width = joint_width(scene, system);
  std::string text = fmt::format("  {:{}}  rows  bodies", "joint", name_width);
  for (const auto& joint : system.joints) {
    const SceneJoint& source = source_of(scene, joint);
    text += fmt::format("\n  {:{}}  {:4}  {}", source.name, name_width, joint.rows, source.definition.type);
    for (int body : joint.body) text += " " + body_name(scene, system, body);
  }
  return text + "\n";
}

// The columns of one body of every row.
std::string numbers_text(const Scene& scene, const SystemMatrix& system) {
  const char* planar[] = {"vx", "vy", "w"};
  const char* in_space[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
  const char** names = system.freedom == 3 ? planar : in_space;
  std::string text;
  for (int k = 0; k < static_cast<int>(system.bodies.size()); ++k) {
    text += fmt::format("\nD, columns of {}:\n", body_name(scene, system, k));
    text += fmt::format("  {:20}", "");
    for (int c = 0; c < system.freedom; ++c) text += fmt::format(" {:>12}", names[c]);
    text += "\n";
    for (const auto& joint : system.joints) {
      if (system.empty_block(joint, k)) continue;
      const SceneJoint& source = source_of(scene, joint);
      const JointType& type = *find_joint_type(scene.dimension, source.definition.type);
      for (int r = 0; r < joint.rows; ++r) {
        text += fmt::format("  {:20}", fmt::format("{}.{}", source.name, type.row_names[r]));
        for (int c = 0; c < system.freedom; ++c)
          text += fmt::format(" {:12.6g}", without_round_off(system.entry(joint.first + r, system.freedom * k + c)));
        text += "\n";
      }
    }
  }
  return text;
}

}  // namespace

SystemMatrix system_matrix(const Scene& scene) {
  return in_space_of<double>(scene, [&]<class S>(S) {
    auto world = build_world_in<S>(scene);
    return system_matrix(world);
  });
}

std::string matrix_text(const Scene& scene, const SystemMatrix& system) {
  const int frozen = static_cast<int>(std::count(system.frozen.begin(), system.frozen.end(), char{1}));
  std::string text =
      fmt::format("D v = 0: {} x {}, {} of {}, columns of {}\nrank {}: {} left, {}\n", system.rows, system.columns,
                  plural(system.rows, "row", "rows"), plural(static_cast<int>(system.joints.size()), "joint", "joints"),
                  plural(static_cast<int>(system.bodies.size()), "body", "bodies"), system.rank,
                  plural(system.degrees_of_freedom, "degree of freedom", "degrees of freedom"),
                  system.rank == system.rows ? std::string("no redundant rows")
                                             : plural(system.rows - system.rank, "redundant row", "redundant rows"));
  if (frozen > 0)
    text += fmt::format("{} of bodies that may not turn count as no freedom\n", plural(frozen, "column", "columns"));
  text += fmt::format("K = D M^-1 D^T: {0} x {0}, {1} of {2} entries are not 0\n", system.rows, entries_of_K(system),
                      system.rows * system.rows);
  const ConflictGraph graph = conflicts(system);
  text += fmt::format("{} of joints share a body: {} of joints that do not\n\n",
                      plural(static_cast<int>(graph.edges.size()), "pair", "pairs"),
                      plural(graph.colours, "group", "groups"));
  const bool narrow = static_cast<int>(system.bodies.size()) <= most_bodies;
  text += narrow ? blocks_text(scene, system) : list_text(scene, system);
  if (system.rows > most_rows || system.columns > most_columns)
    return text + "\nThe numbers are too many to read; --json has them all.\n";
  return text + numbers_text(scene, system);
}

std::string matrix_json(const Scene& scene, const SystemMatrix& system) {
  using Json = nlohmann::ordered_json;
  Json json = {{"rows", system.rows},
               {"columns", system.columns},
               {"rank", system.rank},
               {"degrees_of_freedom", system.degrees_of_freedom}};
  json["bodies"] = json["joints"] = json["D"] = json["K"] = json["conflicts"] = Json::array();
  for (int k = 0; k < static_cast<int>(system.bodies.size()); ++k)
    json["bodies"].push_back({{"name", body_name(scene, system, k)}, {"first_column", system.freedom * k}});
  const ConflictGraph graph = conflicts(system);
  for (std::size_t i = 0; i < system.joints.size(); ++i) {
    const auto& joint = system.joints[i];
    const SceneJoint& source = source_of(scene, joint);
    json["joints"].push_back({{"name", source.name},
                              {"type", source.definition.type},
                              {"first_row", joint.first},
                              {"rows", joint.rows},
                              {"colour", graph.colour[i]}});
  }
  for (const auto& [a, b] : graph.edges)
    json["conflicts"].push_back({source_of(scene, system.joints[static_cast<std::size_t>(a)]).name,
                                 source_of(scene, system.joints[static_cast<std::size_t>(b)]).name});
  const auto add_rows = [&](const char* key, const std::vector<double>& matrix, int columns) {
    for (int r = 0; r < system.rows; ++r)
      json[key].push_back(std::vector<double>(matrix.begin() + r * columns, matrix.begin() + (r + 1) * columns));
  };
  add_rows("D", system.D, system.columns);
  add_rows("K", system.K, system.rows);
  return json.dump() + "\n";
}

}  // namespace cdot
