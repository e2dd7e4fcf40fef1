#include "tests/torture/draw/own_effects.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <regex>
#include <set>
#include <unistd.h>

#include "runtime/own/own.hpp"

namespace cdot::torture {
namespace {

// The subject of a spec.
enum class About { bodies_in_plane, bodies_in_space, lengths, angles };

bool of_bodies(About about) { return about == About::bodies_in_plane || about == About::bodies_in_space; }

// A number without a unit in front of a term.
std::string weight(Random& random) { return fmt::format("{:.2f}", random.either_sign(random.between(0.2, 2))); }

// Writes one spec. Its numbers have names, so that each mechanism gives it values of its own scales.
class Writer {
 public:
  Writer(Random& random, About about) : random_(random), about_(about) {}

  std::string text(const std::string& name, int late) {
    declare_coordinate();
    if (late >= 0) write_late_end(late);
    else if (random_.chance(0.3)) write_row();
    else write_law();
    const char* const space = about_ == About::bodies_in_plane   ? "planar"
                              : about_ == About::bodies_in_space ? "spatial"
                                                                 : "coordinate";
    const std::string law = std::regex_replace(law_, std::regex(R"(\bu\b)"), "((s - rest)/size)");
    return fmt::format("effect {} {}\n  \"Drawn at random.\"\n\n{}\n{}", name, space, head_, law);
  }

 private:
  void scalar(const std::string& name, const std::string& unit, const std::string& range) {
    head_ += fmt::format("scalar {} [{}]{}\n", name, unit, range);
  }
  void declare_coordinate();
  std::string of_u();
  std::string drive();
  std::string resistance();
  void write_law();
  void write_pushes();
  void write_row();
  void write_late_end(int number);

  Random& random_;
  About about_;
  bool turns_ = false, alone_ = false, distance_ = false;  // alone: of one body, which it pushes from outside
  std::string head_, law_, force_;
};

void Writer::declare_coordinate() {
  turns_ = about_ == About::angles || (about_ == About::bodies_in_plane && random_.chance(0.3));
  alone_ = of_bodies(about_) && random_.chance(0.3);
  const std::string unit = turns_ ? "rad" : "m";
  std::string value;
  if (of_bodies(about_)) {
    const bool along = !turns_ && random_.chance(0.4);
    if (!turns_) head_ += fmt::format("point  pa on a\npoint  pb on {}\n", alone_ ? "world" : "b");
    if (along) head_ += fmt::format("unit   t on {}\n", alone_ ? "world" : "b");
    distance_ = !turns_ && !along;
    value = turns_ ? (alone_ ? "angle(a)" : "angle(a) - angle(b)") : along ? "dot(t, pa - pb)" : "norm(pa - pb)";
  }
  const std::string coordinate = fmt::format("coordinate s [{}]{}{}\n", unit, value.empty() ? "" : " = ", value);
  if (!of_bodies(about_)) head_ += coordinate;
  force_ = turns_ ? "N*m" : "N";
  scalar("rest", unit, " = " + (value.empty() ? "s" : value));
  scalar("size", unit, " above 0");
  if (of_bodies(about_)) head_ += coordinate;
}

// A smooth function of about 1 of u, the share of its size by which s has left its rest.
std::string Writer::of_u() {
  return random_.of<std::string>({"u^2/2", "u^4/4", "cos(u)", "sqrt(1 + u^2)", "log(1 + u^2)", "exp(-u^2)",
                                  "1/(1 + u^2)", "u*sin(u)", "u^2/(1 + u^2)"});
}

// A force that puts energy in, of about f.
std::string Writer::drive() {
  return random_.of<std::string>({"f*cos(omega*time)", "f*sin(omega*time + u)", "f*u*cos(omega*time)",
                                  "f*exp(-omega*time)", "f*u/(1 + u^2)*sin(2*omega*time)",
                                  "c*(1 - u^2)*rate(s)/(1 + u^4)"});
}

// A force that takes energy.
std::string Writer::resistance() {
  std::vector<std::string> all = {"-c*rate(s)", "-c*rate(s)/(1 + u^2)", "-c*rate(s)*sqrt(1 + (rate(s)/(omega*size))^2)",
                                  "-f*rate(s)/sqrt((omega*size)^2 + rate(s)^2)", "-c*u^2*rate(s)"};
  if (!of_bodies(about_)) all.push_back("-mass(s)*omega*rate(s)");
  return random_.of(all);
}

// Energy, forces along the coordinate, forces on points and bodies: one or more of them.
void Writer::write_law() {
  scalar("f", force_, " above 0");
  scalar("c", turns_ ? "N*m*s/rad" : "N*s/m", " above 0");
  scalar("omega", "1/s", " above 0");
  const bool stores = random_.chance(0.6);
  if (stores) {
    law_ += fmt::format("energy f*size*({}", random_.chance(0.7) ? "" : "-") + of_u();
    if (random_.chance(0.5)) law_ += fmt::format(" + {}*{}", weight(random_), of_u());
    law_ += ")\n";
  }
  if (!stores || random_.chance(0.4)) {
    std::string force = random_.chance(0.5) ? resistance() : drive();
    if (random_.chance(0.3)) force += " + " + drive();
    const bool cut = !stores && random_.chance(0.4);
    law_ += fmt::format("force on s = {}{}\n", force, cut ? ", within [-f, f]" : "");
  }
  if (alone_ && random_.chance(0.6)) write_pushes();
}

void Writer::write_pushes() {
  if (turns_) {
    law_ += random_.of<std::string>({"torque on a = -c*w(a)\n", "torque on a = f*cos(omega*time)\n"});
    return;
  }
  law_ += random_.of<std::string>({"force on pa = -c*v(pa)\n", "force on a = -c*v(a)\n",
                                   "force on pa = f*cos(omega*time)*unit(pa - pb)\n",
                                   "force on pa = -c*sqrt(1 + dot(v(pa), v(pa))/(omega*size)^2)*v(pa)\n"});
}

// A bounded row, perhaps from an event on or up to one.
void Writer::write_row() {
  scalar("f", force_, " above 0");
  scalar("omega", "1/s", " above 0");
  scalar("t0", "s", " above 0");
  const std::string unit = turns_ ? "rad" : "m";
  if (random_.chance(0.4)) {
    scalar("lower", unit, "");
    scalar("upper", unit, "");
    law_ = random_.of<std::string>({"end: s >= rest + lower", "end: s <= rest + upper",
                                    "end: s in [rest + lower, rest + upper]",
                                    "end: s in [rest + 2*lower, rest + 3*upper]"});
  } else {
    const std::string speed = random_.of<std::string>(
        {"0", "omega*size", "-omega*size", "omega*size*cos(omega*time)", "omega*size/(1 + omega*time)"});
    law_ = fmt::format(
        "drive: rate(s) = {}, force in {}", speed,
        random_.of<std::string>({"[-f, f]", "[0, f]", "[-f*exp(-u^2), f]", "[-f*(1 + u^2), f*(2 + cos(omega*time))]"}));
  }
  const std::string row = law_.substr(0, law_.find(':'));
  // An end that began to hold where it is passed would ask for a jump.
  const std::string begins = row == "drive" ? ", after time >= t0" : ", after s >= rest";
  if (random_.chance(0.4)) law_ += random_.of<std::string>({begins, ", until time >= t0", ", until s >= rest + size"});
  else if (random_.chance(0.3)) law_ += fmt::format(", until load({}) >= f/2", row);
  law_ += "\n";
}

// Ends near the rest, which bodies may have passed by then, and ends that the rest itself passes. None asks for a
// distance below 0.
void Writer::write_late_end(int number) {
  const std::string rest = distance_ ? "abs(rest)" : "rest", beyond = distance_ ? "abs(rest)/2" : "rest - upper/8";
  const std::string ends[late_specs] = {"s >= " + rest + " + lower/8", "s <= " + rest + " + upper/8",
                                        "s in [" + rest + " + lower/8, " + rest + " + upper]", "s <= " + beyond,
                                        "s >= " + rest + " + upper/8"};
  const std::string unit = turns_ ? "rad" : "m";
  scalar("lower", unit, "");
  scalar("upper", unit, "");
  scalar("t0", "s", " above 0");
  law_ = fmt::format("end: {}, after time >= t0\n", ends[number]);
}

const char* word_of(About about) {
  switch (about) {
    case About::bodies_in_plane: return "plane";
    case About::bodies_in_space: return "space";
    case About::lengths: return "length";
    default: return "angle";
  }
}

std::string text_of_spec(About about, int number) {
  Random random(static_cast<std::uint64_t>(number) * 4 + static_cast<std::uint64_t>(about));
  return Writer(random, about).text(fmt::format("own_{}_{}", word_of(about), number), number - own_specs);
}

// The name of the type, derived at its first use.
std::string registered(About about, int number) {
  const std::string name = fmt::format("own_{}_{}", word_of(about), number);
  static std::set<std::string> known;
  if (!known.insert(name).second) return name;
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("cdot_torture_{}_own", getpid());
  const std::string file = folder / (name + ".effect");
  std::filesystem::create_directories(folder);
  std::ofstream(file) << text_of_spec(about, number);
  const OwnType own = add_own_type(file);
  std::filesystem::remove_all(folder);
  if (own.name != name) throw Error(own.problems + text_of_spec(about, number));
  return name;
}

}  // namespace

namespace {

// One of `count` specs of each kind, from the number `first` on.
EffectTypes drawn_from(Random& random, Dimension dimension, int first, int count) {
  const About bodies = dimension == Dimension::planar ? About::bodies_in_plane : About::bodies_in_space;
  const std::string on_bodies = registered(bodies, first + random.below(count)),
                    on_lengths = registered(About::lengths, first + random.below(count)),
                    on_angles = registered(About::angles, first + random.below(count));
  return {{find_joint_type(dimension, on_bodies)},
          {find_coordinate_effect(on_lengths), find_coordinate_effect(on_angles)}};
}

// The number of an own type; -1: it is none.
int number_of(const std::string& type) {
  return type.starts_with("own_") ? std::stoi(type.substr(type.rfind('_') + 1)) : -1;
}

}  // namespace

EffectTypes own_effects(Random& random, Dimension dimension) { return drawn_from(random, dimension, 0, own_specs); }

EffectTypes late_ends(Random& random, Dimension dimension) {
  return drawn_from(random, dimension, own_specs, late_specs);
}

bool has_late_ends(const Scene& scene) {
  const auto is_late = [](const std::string& type) { return number_of(type) >= own_specs; };
  return std::ranges::any_of(scene.joints, [&](const SceneJoint& joint) {
    return is_late(joint.definition.type) || std::ranges::any_of(joint.effects, [&](const CoordinateEffects& effects) {
             return std::ranges::any_of(effects.specs, is_late, &SpecEffect::type);
           });
  });
}

std::vector<std::pair<std::string, std::string>> own_specs_of(const Scene& scene) {
  std::set<std::string> names;
  for (const SceneJoint& joint : scene.joints) {
    names.insert(joint.definition.type);
    for (const CoordinateEffects& effects : joint.effects)
      for (const SpecEffect& spec : effects.specs) names.insert(spec.type);
  }
  std::vector<std::pair<std::string, std::string>> files;
  for (const About about : {About::bodies_in_plane, About::bodies_in_space, About::lengths, About::angles}) {
    const std::string stem = fmt::format("own_{}_", word_of(about));
    for (const std::string& name : names)
      if (name.starts_with(stem))
        files.emplace_back(name + ".effect", text_of_spec(about, std::stoi(name.substr(stem.size()))));
  }
  return files;
}

}  // namespace cdot::torture
