#include "tests/torture/draw/scene_text.hpp"

#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

#include <cdot/methods.hpp>

#include "tests/torture/numbers.hpp"

namespace cdot::torture {
namespace {

// Collects the lines of one table: "key = value".
class Lines {
 public:
  explicit Lines(std::string& text) : text_(&text) {}

  void raw(std::string_view key, std::string_view value) { *text_ += fmt::format("{} = {}\n", key, value); }
  void text(std::string_view key, std::string_view value) { raw(key, fmt::format("\"{}\"", value)); }
  void number(std::string_view key, double value) { raw(key, fmt::format("{}", value)); }
  void number_unless(double usual, std::string_view key, double value) {
    if (value != usual) number(key, value);
  }
  void flag_unless(bool usual, std::string_view key, bool value) {
    if (value != usual) raw(key, value ? "true" : "false");
  }

 private:
  std::string* text_;
};

std::string list(const std::vector<double>& numbers) { return fmt::format("[{}]", fmt::join(numbers, ", ")); }

std::vector<double> in_dimension(const Scene& scene, Vec3 v) {
  return {v.begin(), v.begin() + (scene.dimension == Dimension::planar ? 2 : 3)};
}

void write_settings(const Scene& scene, Lines lines) {
  const Settings& s = scene.settings;
  const Settings usual;
  if (!scene.title.empty()) lines.text("title", scene.title);
  if (scene.dimension == Dimension::spatial) lines.raw("dimension", "3");
  lines.raw("gravity", list(in_dimension(scene, {s.gravity_x, s.gravity_y, s.gravity_z})));
  lines.number("duration", scene.duration);
  lines.number("step", scene.step);
  lines.text("solver", name_of(solvers, s.solver));
  lines.text("integrator", name_of(integrators, s.integrator));
  lines.text("precision", name_of(precisions, scene.single));
  if (s.drift != usual_drift(s)) lines.text("drift", name_of(drifts, s.drift));
  if (s.kernels != usual.kernels) lines.text("kernels", name_of(kernel_forms, s.kernels));
  lines.number_unless(usual.local_error, "local_error", s.local_error);
  lines.number_unless(usual.iterations, "iterations", s.iterations);
  lines.number_unless(usual.substeps, "substeps", s.substeps);
  lines.number_unless(usual.baumgarte, "baumgarte", s.baumgarte);
  lines.flag_unless(usual.warm_start, "warm_start", s.warm_start);
  lines.number_unless(usual.sleep_after, "sleep_after", s.sleep_after);
  lines.number_unless(usual.sleep_speed, "sleep_speed", s.sleep_speed);
  lines.number_unless(Scene{}.tolerance, "tolerance", scene.tolerance);
  if (scene.on_failure != OnFailure::stop) lines.text("on_failure", name_of(failure_answers, scene.on_failure));
  lines.flag_unless(false, "project", scene.project);
}

void write_planar(const BodyDefinition& d, Lines lines) {
  const auto pair = [&](std::string_view key, double x, double y) {
    if (x != 0 || y != 0) lines.raw(key, list({x, y}));
  };
  lines.number_unless(0, "mass", d.mass);
  if (!d.is_static) lines.number_unless(0, "inertia", d.inertia);
  lines.flag_unless(false, "fixed_rotation", d.fixed_rotation);
  pair("position", d.x, d.y);
  lines.number_unless(0, "angle", d.angle);
  pair("velocity", d.vx, d.vy);
  lines.number_unless(0, "spin", d.w);
  pair("force", d.force_x, d.force_y);
  lines.number_unless(0, "torque", d.torque);
  lines.number_unless(0, "linear_damping", d.linear_damping);
  lines.number_unless(0, "angular_damping", d.angular_damping);
}

void write_spatial(const SpatialBodyDefinition& d, Lines lines) {
  const auto triple = [&](std::string_view key, double x, double y, double z) {
    if (x != 0 || y != 0 || z != 0) lines.raw(key, list({x, y, z}));
  };
  const Inertia& I = d.inertia;
  lines.number_unless(0, "mass", d.mass);
  if (!d.is_static && I.xx != 0)
    lines.raw("inertia", fmt::format("[{}, {}, {}]", list({I.xx, I.xy, I.xz}), list({I.xy, I.yy, I.yz}),
                                     list({I.xz, I.yz, I.zz})));
  lines.flag_unless(false, "fixed_rotation", d.fixed_rotation);
  triple("position", d.x, d.y, d.z);
  if (d.e0 != 1 || d.e1 != 0 || d.e2 != 0 || d.e3 != 0) lines.raw("orientation", list({d.e0, d.e1, d.e2, d.e3}));
  triple("velocity", d.vx, d.vy, d.vz);
  triple("spin", d.wx, d.wy, d.wz);
  triple("force", d.force_x, d.force_y, d.force_z);
  triple("torque", d.torque_x, d.torque_y, d.torque_z);
  lines.number_unless(0, "linear_damping", d.linear_damping);
  lines.number_unless(0, "angular_damping", d.angular_damping);
}

std::string names(const Scene& scene, const std::vector<int>& bodies) {
  std::string text;
  for (const int body : bodies)
    text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ",
                        body == world_body ? "world" : scene.bodies[static_cast<std::size_t>(body)].name);
  return "[" + text + "]";
}

std::string softness(const Softness& s) {
  return s.by_frequency ? fmt::format("frequency = {}, damping_ratio = {}", s.frequency, s.damping_ratio)
                        : fmt::format("stiffness = {}, damping = {}", s.stiffness, s.damping);
}

// A damper is a spring without stiffness and without a given rest.
bool is_damper(const CoordinateSpring& spring) {
  return !spring.softness.by_frequency && spring.softness.stiffness == 0 && spring.rest == 0.0;
}

std::string file_of(const WrittenProfile& table) { return fmt::format("{:016x}.csv", table.profile.hash()); }

std::string function_of(const WrittenProfile& written) {
  if (written.table.times.empty()) return fmt::format("\"{}\"", written.text);
  const std::array names{"step", "linear", "cubic"};
  return fmt::format("{{ table = \"{}\", column = \"x\", interpolate = \"{}\" }}", file_of(written),
                     names[static_cast<std::size_t>(written.table.interpolation)]);
}

// Number k of a value, or the function of time that it follows.
std::string number_of(const Scene& scene, const NamedValue& value, std::size_t k) {
  for (const NumberInTime& one : value.in_time)
    if (one.number == static_cast<int>(k)) return function_of(*written_profile(scene, one.profile));
  return fmt::format("{}", value.numbers[k]);
}

// The numbers [begin, end) of a value.
std::string list_of(const Scene& scene, const NamedValue& value, std::size_t begin, std::size_t end) {
  std::vector<std::string> numbers;
  for (std::size_t k = begin; k < end; ++k) numbers.push_back(number_of(scene, value, k));
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string table_of_numbers(const Scene& scene, const SpecEffect& spec) {
  std::string numbers;
  for (const NamedValue& value : spec.parameters)
    numbers += fmt::format("{}{} = {}", numbers.empty() ? "" : ", ", value.name, number_of(scene, value, 0));
  return fmt::format("{{ {} }}", numbers);
}

void write_effects(const Scene& scene, const CoordinateEffects& effects, Lines lines) {
  const auto key = [&](std::string_view effect) { return fmt::format("{}.{}", effects.coordinate, effect); };
  if (const auto& limit = effects.limit) {
    std::string ends;
    if (limit->lower) ends += fmt::format("lower = {}", *limit->lower);
    if (limit->upper) ends += fmt::format("{}upper = {}", ends.empty() ? "" : ", ", *limit->upper);
    lines.raw(key("limit"), "{ " + ends + " }");
  }
  if (const auto& motor = effects.motor)
    lines.raw(key("motor"), motor->max_force == unlimited
                                ? fmt::format("{{ speed = {} }}", motor->speed)
                                : fmt::format("{{ speed = {}, max = {} }}", motor->speed, motor->max_force));
  for (const SpecEffect& spec : effects.specs)
    lines.raw(key(spec.type),
              spec.type == "load" ? number_of(scene, spec.parameters[0], 0) : table_of_numbers(scene, spec));
  for (const CoordinateSpring& spring : effects.springs) {
    if (is_damper(spring)) lines.number(key("damper"), spring.softness.damping);
    else
      lines.raw(key("spring"), fmt::format("{{ {}{} }}", softness(spring.softness),
                                           spring.rest ? fmt::format(", rest = {}", *spring.rest) : ""));
  }
  if (effects.friction) lines.number(key("friction"), effects.friction->max_force);
  if (effects.load) lines.number(key("load"), effects.load->force);
}

void write_joint(const Scene& scene, const SceneJoint& joint, Lines lines) {
  lines.text("name", joint.name);
  lines.text("type", joint.definition.type);
  lines.raw("bodies", names(scene, joint.definition.bodies));
  for (const NamedValue& value : joint.definition.parameters) {
    const std::size_t n = value.numbers.size();
    lines.raw(value.name, n == 1   ? number_of(scene, value, 0)
                          : n == 6 ? fmt::format("[{}, {}]", list_of(scene, value, 0, 3), list_of(scene, value, 3, 6))
                                   : list_of(scene, value, 0, n));
  }
  for (const CoordinateEffects& effects : joint.effects) write_effects(scene, effects, lines);
  if (joint.definition.soft) lines.raw("soft", fmt::format("{{ {} }}", softness(*joint.definition.soft)));
  for (const SpecEffect& bond : joint.bonds) lines.raw(bond.type, table_of_numbers(scene, bond));
}

void write_spring(const Scene& scene, const SpringDefinition& spring, Lines lines) {
  lines.raw("bodies", names(scene, {spring.body_a, spring.body_b}));
  lines.raw("pa", list(in_dimension(scene, {spring.ax, spring.ay, spring.az})));
  lines.raw("pb", list(in_dimension(scene, {spring.bx, spring.by, spring.bz})));
  lines.number("stiffness", spring.stiffness);
  lines.number("damping", spring.damping);
  lines.number("rest", spring.rest_length);
}

}  // namespace

std::string text_of(const Scene& scene) {
  std::string text;
  const Lines lines(text);
  write_settings(scene, lines);
  for (const SceneBody& body : scene.bodies) {
    text += fmt::format("\n[[body]]\nname = \"{}\"\n", body.name);
    if (body.is_static) text += "static = true\n";
    if (scene.dimension == Dimension::planar) write_planar(body.definition, lines);
    else write_spatial(body.spatial, lines);
  }
  for (const SceneJoint& joint : scene.joints) {
    text += "\n[[joint]]\n";
    write_joint(scene, joint, lines);
  }
  for (const SpringDefinition& spring : scene.springs) {
    text += "\n[[spring]]\n";
    write_spring(scene, spring, lines);
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> tables_of(const Scene& scene) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const WrittenProfile& one : scene.profiles) {
    std::string text = "time,x\n";
    for (std::size_t k = 0; k < one.table.times.size(); ++k)
      text += fmt::format("{},{}\n", one.table.times[k], one.table.values[k]);
    if (!one.table.times.empty()) files.emplace_back(file_of(one), text);
  }
  return files;
}

Scene copy_of(const Scene& scene) {
  const auto tables = tables_of(scene);
  if (tables.empty()) return read_scene(text_of(scene), "copy");
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("cdot_torture_{}", getpid());
  std::filesystem::create_directories(folder);
  for (const auto& [name, text] : tables) std::ofstream(folder / name) << text;
  Scene copy = read_scene(text_of(scene), (folder / "copy").string());
  std::filesystem::remove_all(folder);
  return copy;
}

void plain_zeros(Scene& scene) {
  each_number(scene, [](double& x) { x += 0.0; });
}

}  // namespace cdot::torture
