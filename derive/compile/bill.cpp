#include "derive/compile/bill.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>

#include "derive/compile/measure.hpp"

namespace cdot::compile {
namespace {

constexpr double most_seconds = 120;  // of compiling and counting

// Bodies that nothing acts on.
Mechanism bare(Mechanism mechanism) {
  mechanism.gravity = {};
  mechanism.joints.clear();
  mechanism.effects.clear();
  mechanism.bounded.clear();
  for (Body& b : mechanism.bodies) {
    std::ranges::fill(b.acceleration, 0);
    b.torque = {}, b.linear_drag = b.angular_drag = 0;
  }
  return mechanism;
}

class Parts {
 public:
  explicit Parts(const Mechanism& mechanism) : all_(mechanism) {}

  std::vector<Part> list() {
    if (all_.gravity != decltype(all_.gravity){})
      add("gravity", [](const Mechanism& from, Mechanism& to) { to.gravity = from.gravity; });
    for (std::size_t b = 0; b < all_.bodies.size(); ++b) list_body(b);
    for (std::size_t j = 0; j < all_.joints.size(); ++j)
      add_of(fmt::format("joint {} ({})", all_.joints[j].name, all_.joints[j].type), &Mechanism::joints, j);
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

class BillWriter {
 public:
  BillWriter(const Mechanism& mechanism, const derive::SpecsFolder& specs)
      : mechanism_(mechanism), specs_(specs), parts_(parts_of(mechanism)) {}

  std::string write() {
    const Header whole = header(mechanism_), none = header(bare(mechanism_));
    std::vector<Header> without;
    std::vector<Source> sources = {{whole.text, whole.struct_name}, {none.text, none.struct_name}};
    for (const Part& part : parts_) {
      without.push_back(header(part.without));
      sources.push_back({without.back().text, without.back().struct_name});
    }
    std::vector<std::string> notes;
    const std::vector<Measured> measured = measure(sources, most_seconds, notes);
    write_head();
    line("bodies", none, none, measured[1].code, measured[1].instructions);
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const Measured& rest = measured[k + 2];
      Header alone = header(parts_[k].alone), saved = whole;
      alone.operations -= none.operations, alone.state_bytes -= none.state_bytes;
      saved.operations -= without[k].operations, saved.state_bytes -= without[k].state_bytes;
      line(parts_[k].name, alone, saved, difference(measured[0].code, rest.code),
           difference(measured[0].instructions, rest.instructions));
    }
    line("whole step", whole, whole, measured[0].code, measured[0].instructions);
    text_ += "\n";
    for (const std::string& note : notes) text_ += "note: " + note + "\n";
    return std::move(text_);
  }

 private:
  Header header(const Mechanism& mechanism) const {
    return header_of(mechanism, {"bill", "cdot compile --bill"}, specs_);
  }

  static std::optional<long> difference(std::optional<long> a, std::optional<long> b) {
    return a && b ? std::optional(*a - *b) : std::nullopt;
  }

  void write_head() {
    for (const Part& part : parts_) width_ = std::max(width_, part.name.size());
    text_ += fmt::format("{}: a step of {}\n", mechanism_.title.empty() ? mechanism_.file : mechanism_.title,
                         mechanism_.method_name);
    text_ += "Operations of the equations, with one round of Newton. State in double. Code and instructions with\n";
    text_ += fmt::format("{}; instructions by callgrind, the mean of a step\nfrom each of the first {} states.\n\n",
                         measured_options, measured_steps);
    text_ += fmt::format("{:<{}}  {:>18}  {:>46}\n", "", width_, "alone", "saved by dropping it");
    text_ += fmt::format("{:<{}}  {:>10}  {:>6}  {:>10}  {:>6}  {:>12}  {:>12}\n", "", width_, "operations", "bytes",
                         "operations", "bytes", "code bytes", "instructions");
  }

  void line(const std::string& name, const Header& alone, const Header& saved, std::optional<long> code,
            std::optional<long> instructions) {
    const auto number = [](std::optional<long> n) { return n ? std::to_string(*n) : "-"; };
    text_ += fmt::format("{:<{}}  {:>10}  {:>6}  {:>10}  {:>6}  {:>12}  {:>12}\n", name, width_, alone.operations,
                         alone.state_bytes, saved.operations, saved.state_bytes, number(code), number(instructions));
  }

  const Mechanism& mechanism_;
  const derive::SpecsFolder& specs_;
  std::vector<Part> parts_;
  std::size_t width_ = 10;
  std::string text_;
};

}  // namespace

std::vector<Part> parts_of(const Mechanism& mechanism) { return Parts(mechanism).list(); }

std::string bill_of(const Mechanism& mechanism, const derive::SpecsFolder& specs) {
  return BillWriter(mechanism, specs).write();
}

}  // namespace cdot::compile
