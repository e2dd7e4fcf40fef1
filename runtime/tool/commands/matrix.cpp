// The matrix of a system -> text, JSON and a picture.
#include "runtime/tool/commands/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "runtime/text/html.hpp"
#include "runtime/text/json.hpp"
#include "runtime/tool/viewer/picture.hpp"

namespace cdot {
namespace {

// Larger matrices are not readable as text.
constexpr int most_columns = 60, most_rows = 60, most_bodies = 12;

// The cosine of a quarter turn shows as 0, not 6e-17. The JSON has all digits.
double without_round_off(double entry) { return std::fabs(entry) < 1e-15 ? 0.0 : entry; }

// Springs follow the joints in the World.
const SceneJoint& source_of(const Scene& scene, const SystemMatrix::Joint& joint) {
  static const SceneJoint spring = [] {
    SceneJoint of_world;
    of_world.name = "spring", of_world.definition.type = "distance";
    return of_world;
  }();
  return joint.joint < std::ssize(scene.joints) ? scene.joints[static_cast<std::size_t>(joint.joint)] : spring;
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

// One line per joint: a block of rows x columns for each of its bodies, or their names if there are many bodies.
std::string joints_text(const Scene& scene, const SystemMatrix& system) {
  const int bodies = static_cast<int>(system.bodies.size());
  const bool narrow = bodies <= most_bodies;
  std::size_t name_width = 5, width = 6;
  for (const auto& joint : system.joints) name_width = std::max(name_width, source_of(scene, joint).name.size());
  for (int k = 0; k < bodies; ++k) width = std::max(width, body_name(scene, system, k).size() + 2);
  std::string text = fmt::format("  {:{}}  rows {}", "joint", name_width, narrow ? "" : " bodies");
  for (int k = 0; k < bodies && narrow; ++k) text += fmt::format("{:>{}}", body_name(scene, system, k), width);
  for (const auto& joint : system.joints) {
    const SceneJoint& source = source_of(scene, joint);
    text += fmt::format("\n  {:{}}  {:4} ", source.name, name_width, joint.rows);
    for (int k = 0; k < bodies && narrow; ++k) {
      const bool empty = system.empty_block(joint, k);
      text += fmt::format("{:>{}}", empty ? "." : fmt::format("{}x{}", joint.rows, system.freedom), width);
    }
    text += (narrow ? "  " : " ") + source.definition.type;
    if (narrow) continue;
    for (int body : joint.body) text += " " + body_name(scene, system, body);
  }
  return text + "\n";
}

// The numbers of D, body by body.
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
    text += fmt::format("{} of bodies that cannot turn: not counted as freedom\n", plural(frozen, "column", "columns"));
  text += fmt::format("K = D M^-1 D^T: {0} x {0}, {1} of {2} entries are not 0\n", system.rows, entries_of_K(system),
                      system.rows * system.rows);
  const ConflictGraph graph = conflicts(system);
  text += fmt::format("{} of joints share a body: {} without shared bodies\n\n",
                      plural(static_cast<int>(graph.edges.size()), "pair", "pairs"),
                      plural(graph.colours, "group", "groups"));
  text += joints_text(scene, system);
  if (system.rows > most_rows || system.columns > most_columns)
    return text + "\nToo many numbers to show; --json prints all.\n";
  return text + numbers_text(scene, system);
}

std::string matrix_json(const Scene& scene, const SystemMatrix& system) {
  using text::Json;
  Json json = {{"rows", system.rows},
               {"columns", system.columns},
               {"rank", system.rank},
               {"degrees_of_freedom", system.degrees_of_freedom}};
  for (const char* list : {"conflicts", "K", "D", "joints", "bodies"}) json[list] = Json::array();
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

namespace {

// --- The picture.

constexpr double picture = 640, gap = 60, margin = 70;
constexpr const char* palette[] = {"#3b82f6", "#f59e0b", "#10b981", "#ef4444",
                                   "#8b5cf6", "#06b6d4", "#84cc16", "#ec4899"};

const char* colour(const ConflictGraph& graph, std::size_t joint) { return palette[graph.colour[joint] % 8]; }

std::string name_of(const Scene& scene, const SystemMatrix& system, std::size_t joint) {
  return text::html_escaped(source_of(scene, system.joints[joint]).name);
}

// A square per entry that is not 0, the diagonal block of each joint in its colour, lines between joints.
std::string sparsity(const Scene& scene, const SystemMatrix& system, const ConflictGraph& graph) {
  const double cell = picture / std::max(system.rows, 1);
  std::string svg = fmt::format(
      "<g transform=\"translate({} {})\">\n<rect width=\"{:.0f}\" height=\"{:.0f}\" "
      "class=\"paper\"/>\n",
      margin, margin, picture, picture);
  for (std::size_t i = 0; i < system.joints.size(); ++i) {
    const auto& joint = system.joints[i];
    const double at = cell * joint.first, size = cell * joint.rows;
    svg += fmt::format(
        "<rect x=\"{0:.2f}\" y=\"{0:.2f}\" width=\"{1:.2f}\" height=\"{1:.2f}\" fill=\"{2}\" "
        "opacity=\".25\"/>\n",
        at, size, colour(graph, i));
    svg += fmt::format("<path class=\"line\" d=\"M0 {0:.2f}H{1:.0f}M{0:.2f} 0V{1:.0f}\"/>\n", at, picture);
    if (size >= 10)
      svg += fmt::format("<text x=\"-8\" y=\"{:.2f}\" text-anchor=\"end\">{}</text>\n", at + size / 2 + 4,
                         name_of(scene, system, i));
  }
  std::string cells;
  for (int r = 0; r < system.rows; ++r)
    for (int c = 0; c < system.rows; ++c)
      if (system.K[static_cast<std::size_t>(r) * static_cast<std::size_t>(system.rows) + static_cast<std::size_t>(c)] !=
          0)
        cells +=
            fmt::format("M{0:.2f} {1:.2f}h{2:.2f}v{2:.2f}h-{2:.2f}z", cell * (c + 0.1), cell * (r + 0.1), 0.8 * cell);
  return svg + fmt::format("<path class=\"entry\" d=\"{}\"/>\n</g>\n", cells);
}

std::string graph_svg(const Scene& scene, const SystemMatrix& system, const ConflictGraph& graph) {
  const std::size_t count = system.joints.size();
  const double radius = picture / 2 - 20;
  const auto place = [&](std::size_t i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    return std::pair{radius * std::sin(angle), -radius * std::cos(angle)};
  };
  std::string svg = fmt::format("<g transform=\"translate({:.0f} {:.0f})\">\n",
                                margin + picture + gap + margin + picture / 2, margin + picture / 2);
  for (const auto& [a, b] : graph.edges) {
    const auto [x, y] = place(static_cast<std::size_t>(a));
    const auto [u, v] = place(static_cast<std::size_t>(b));
    svg += fmt::format("<path class=\"edge\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x, y, u, v);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto [x, y] = place(i);
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n", x, y, count > 60 ? 4 : 9,
                       colour(graph, i));
    if (count <= 60)
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x * 1.09, y * 1.09 + 4,
                         name_of(scene, system, i));
  }
  return svg + "</g>\n";
}

}  // namespace

std::string matrix_svg(const Scene& scene, const SystemMatrix& system) {
  const ConflictGraph graph = conflicts(system);
  const double width = 2 * picture + gap + 3 * margin, height = picture + 2 * margin;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n",
      width, height);
  svg += R"(<style>
svg { --ink: #1f2328; --paper: #fff; font: 12px sans-serif; }
@media (prefers-color-scheme: dark) { svg { --ink: #e6edf3; --paper: #0d1117; } }
text, .entry { fill: var(--ink); }
.paper { fill: var(--paper); stroke: var(--ink); }
.line, .edge { stroke: var(--ink); stroke-width: .5; opacity: .35; fill: none; }
.edge { stroke-width: 1; }
</style>
)";
  svg += fmt::format("<text x=\"{:.0f}\" y=\"30\">K = D M^-1 D^T, {} x {}</text>\n", margin, system.rows, system.rows);
  svg += fmt::format("<text x=\"{:.0f}\" y=\"30\">joints that share a body, in {} groups without</text>\n",
                     margin + picture + gap + margin, graph.colours);
  svg += sparsity(scene, system, graph) + graph_svg(scene, system, graph);
  return svg + "</svg>\n";
}

}  // namespace cdot
