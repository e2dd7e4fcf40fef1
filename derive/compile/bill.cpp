#include "derive/compile/bill.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <optional>

#include "derive/compile/measure.hpp"
#include "runtime/text/json.hpp"

namespace cdot::compile {
namespace {

constexpr double most_seconds = 120;  // of compiling and counting

// Bodies that nothing acts on.
Mechanism bare(Mechanism mechanism) {
  mechanism.gravity = {};
  mechanism.joints.clear();
  mechanism.effects.clear();
  mechanism.bounded.clear();
  mechanism.bonds.clear();
  mechanism.angles = 0;
  for (Body& b : mechanism.bodies) {
    std::ranges::fill(b.acceleration, 0);
    b.torque = {}, b.linear_drag = b.angular_drag = 0;
  }
  return mechanism;
}

// Numbers the angles of the joints and effects that are left.
void count_angles(Mechanism& mechanism) {
  mechanism.angles = 0;
  for (Joint& joint : mechanism.joints)
    for (CountedTurns& turns : joint.turns) turns.angle = mechanism.angles++;
  for (auto* list : {&mechanism.effects, &mechanism.bounded})
    for (Effect& effect : *list) {
      for (CountedTurns& turns : effect.turns) turns.angle = mechanism.angles++;
      if (effect.angle >= 0) effect.angle = mechanism.angles++;
    }
}

// The place in a part's list of the one at that place in the list of the whole; -1: it is not there.
template <class List>
int place_in(const List& part, const List& whole, int place) {
  if (place < 0) return -1;
  const auto found = std::ranges::find(part, whole[static_cast<std::size_t>(place)].name, &List::value_type::name);
  return found == part.end() ? -1 : static_cast<int>(found - part.begin());
}

// The bonds of the joints and effects that are left, which are numbered anew.
void keep_bonds(const Mechanism& whole, Mechanism& part) {
  std::map<int, int> numbers;
  part.bonds.clear();
  for (Bond bond : whole.bonds) {
    bond.joint = place_in(part.joints, whole.joints, bond.joint);
    bond.effect = place_in(part.effects, whole.effects, bond.effect);
    bond.bounded = place_in(part.bounded, whole.bounded, bond.bounded);
    if (bond.joint < 0 && bond.effect < 0 && bond.bounded < 0) continue;
    bond.holds = numbers.try_emplace(bond.holds, static_cast<int>(numbers.size())).first->second;
    part.bonds.push_back(std::move(bond));
  }
  const auto renumber = [&](auto& list) {
    for (auto& one : list)
      if (one.holds >= 0) one.holds = numbers.contains(one.holds) ? numbers.at(one.holds) : -1;
  };
  renumber(part.joints), renumber(part.effects), renumber(part.bounded);
}

class Parts {
 public:
  explicit Parts(const Mechanism& mechanism) : all_(mechanism) {}

  std::vector<Part> list() {
    if (all_.gravity != decltype(all_.gravity){})
      add("gravity", [](const Mechanism& from, Mechanism& to) { to.gravity = from.gravity; });
    for (std::size_t b = 0; b < all_.bodies.size(); ++b) list_body(b);
    for (std::size_t j = 0; j < all_.joints.size(); ++j)
      add_of(all_.joints[j].coordinate.empty() ? fmt::format("joint {} ({})", all_.joints[j].name, all_.joints[j].type)
                                               : "effect " + all_.joints[j].name,
             &Mechanism::joints, j);
    for (std::size_t e = 0; e < all_.effects.size(); ++e)
      add_of("effect " + all_.effects[e].name, &Mechanism::effects, e);
    for (std::size_t b = 0; b < all_.bounded.size(); ++b)
      add_of("effect " + all_.bounded[b].name, &Mechanism::bounded, b);
    return std::move(parts_);
  }

 private:
  // copy(from, to) gives `to` this part as `from` has it.
  void add(const std::string& name, const std::function<void(const Mechanism& from, Mechanism& to)>& copy) {
    const Mechanism none = bare(all_);
    Part part{name, all_, none};
    copy(none, part.without);
    copy(all_, part.alone);
    parts_.push_back(std::move(part));
  }

  template <class List>
  void add_of(const std::string& name, List Mechanism::*list, std::size_t number) {
    Part part{name, all_, bare(all_)};
    (part.without.*list).erase((part.without.*list).begin() + static_cast<std::ptrdiff_t>(number));
    (part.alone.*list).push_back((all_.*list)[number]);
    count_angles(part.without), count_angles(part.alone);
    keep_bonds(all_, part.without), keep_bonds(all_, part.alone);
    parts_.push_back(std::move(part));
  }

  void list_body(std::size_t b) {
    const Body& body = all_.bodies[b];
    if (!body.moves) return;
    const auto acts = [](double number) { return number != 0; };
    if (std::ranges::any_of(body.acceleration, acts) || std::ranges::any_of(body.torque, acts))
      add("force on " + body.name, [b](const Mechanism& from, Mechanism& to) {
        const Body& of = from.bodies[b];
        to.bodies[b].acceleration = of.acceleration, to.bodies[b].torque = of.torque;
      });
    if (body.linear_drag != 0 || body.angular_drag != 0)
      add("damping of " + body.name, [b](const Mechanism& from, Mechanism& to) {
        const Body& of = from.bodies[b];
        to.bodies[b].linear_drag = of.linear_drag, to.bodies[b].angular_drag = of.angular_drag;
      });
  }

  const Mechanism& all_;
  std::vector<Part> parts_;
};

struct BillLine {
  std::string name;
  long operations_alone = 0, bytes_alone = 0, operations = 0, bytes = 0;  // the last two: saved by dropping it
  std::optional<long> code, instructions;                                 // likewise
};

struct Bill {
  std::string title, method;
  std::vector<BillLine> lines;  // the bodies, the parts, the whole step
  std::vector<std::string> notes;
};

class BillMaker {
 public:
  BillMaker(const Mechanism& mechanism, const derive::SpecsFolder& specs)
      : mechanism_(mechanism), specs_(specs), parts_(parts_of(mechanism)) {}

  Bill make() {
    const Header whole = header(mechanism_), none = header(bare(mechanism_));
    std::vector<Header> without;
    std::vector<Source> sources = {{whole.text, whole.struct_name}, {none.text, none.struct_name}};
    for (const Part& part : parts_) {
      without.push_back(header(part.without));
      sources.push_back({without.back().text, without.back().struct_name});
    }
    Bill bill{mechanism_.title.empty() ? mechanism_.file : mechanism_.title, mechanism_.method_name, {}, {}};
    const std::vector<Measured> measured = measure(sources, most_seconds, bill.notes);
    const auto whole_line = [](const std::string& name, const Header& of, const Measured& cost) {
      return BillLine{name, of.operations, of.state_bytes, of.operations, of.state_bytes, cost.code, cost.instructions};
    };
    bill.lines.push_back(whole_line("bodies", none, measured[1]));
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const Header alone = header(parts_[k].alone);
      const Measured& rest = measured[k + 2];
      bill.lines.push_back({parts_[k].name, alone.operations - none.operations, alone.state_bytes - none.state_bytes,
                            whole.operations - without[k].operations, whole.state_bytes - without[k].state_bytes,
                            difference(measured[0].code, rest.code),
                            difference(measured[0].instructions, rest.instructions)});
    }
    bill.lines.push_back(whole_line("whole step", whole, measured[0]));
    return bill;
  }

 private:
  Header header(const Mechanism& mechanism) const {
    return header_of(mechanism, {"bill", "cdot compile --bill"}, specs_);
  }

  static std::optional<long> difference(std::optional<long> a, std::optional<long> b) {
    return a && b ? std::optional(*a - *b) : std::nullopt;
  }

  const Mechanism& mechanism_;
  const derive::SpecsFolder& specs_;
  std::vector<Part> parts_;
};

std::string text_of(const Bill& bill) {
  std::size_t width = 10;
  for (const BillLine& line : bill.lines) width = std::max(width, line.name.size());
  std::string text = fmt::format("{}: a step of {}\n", bill.title, bill.method);
  text += "Operations of the equations, with one round of Newton. State in double. Code and instructions with\n";
  text += fmt::format("{}; instructions by callgrind, the mean of a step\nfrom each of the first {} states.\n\n",
                      measured_options, measured_steps);
  text += fmt::format("{:<{}}  {:>18}  {:>46}\n", "", width, "alone", "saved by dropping it");
  text += fmt::format("{:<{}}  {:>10}  {:>6}  {:>10}  {:>6}  {:>12}  {:>12}\n", "", width, "operations", "bytes",
                      "operations", "bytes", "code bytes", "instructions");
  const auto number = [](std::optional<long> n) { return n ? std::to_string(*n) : "-"; };
  for (const BillLine& line : bill.lines)
    text +=
        fmt::format("{:<{}}  {:>10}  {:>6}  {:>10}  {:>6}  {:>12}  {:>12}\n", line.name, width, line.operations_alone,
                    line.bytes_alone, line.operations, line.bytes, number(line.code), number(line.instructions));
  text += "\n";
  for (const std::string& note : bill.notes) text += "note: " + note + "\n";
  return text;
}

// Numbers that were not measured are null.
std::string json_of(const Bill& bill) {
  using text::Json;
  const auto number = [](std::optional<long> n) { return n ? Json(*n) : Json(nullptr); };
  Json json{{"title", bill.title}, {"method", bill.method}, {"options", measured_options}};
  json["lines"] = Json::array();
  for (const BillLine& line : bill.lines)
    json["lines"].push_back({{"name", line.name},
                             {"alone", {{"operations", line.operations_alone}, {"bytes", line.bytes_alone}}},
                             {"saved",
                              {{"operations", line.operations},
                               {"bytes", line.bytes},
                               {"code_bytes", number(line.code)},
                               {"instructions", number(line.instructions)}}}});
  json["notes"] = Json(bill.notes);
  return json.dump(2) + "\n";
}

}  // namespace

std::vector<Part> parts_of(const Mechanism& mechanism) { return Parts(mechanism).list(); }

std::string bill_of(const Mechanism& mechanism, const derive::SpecsFolder& specs, bool as_json) {
  const Bill bill = BillMaker(mechanism, specs).make();
  return as_json ? json_of(bill) : text_of(bill);
}

}  // namespace cdot::compile
