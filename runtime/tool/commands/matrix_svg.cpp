// The picture of `cdot-run diagnose --matrix --svg`: the sparsity of K, and the conflict graph of the joints on a
// circle, each joint in the colour in which it could be solved.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "runtime/tool/commands/matrix.hpp"
#include "runtime/tool/viewer/picture.hpp"

namespace cdot {
namespace {

constexpr double picture = 640, gap = 60, margin = 70;
constexpr const char* palette[] = {"#3b82f6", "#f59e0b", "#10b981", "#ef4444",
                                   "#8b5cf6", "#06b6d4", "#84cc16", "#ec4899"};

const char* colour(const ConflictGraph& graph, std::size_t joint) { return palette[graph.colour[joint] % 8]; }

std::string name_of(const Scene& scene, const SystemMatrix& system, std::size_t joint) {
  const auto index = static_cast<std::size_t>(system.joints[joint].joint);
  return escaped(scene.joints[index].name);
}

// A square per entry that is not 0; the diagonal block of each joint in its colour, lines between
// joints.
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
