// Fuzz target: reads any bytes as a spec or as hand derivations and formats every message.
#include <cstddef>
#include <cstdint>

#include "tests/derive/language/reading.hpp"

namespace {

using namespace cdot::derive;

// The joints that the bytes may include or, as hand derivations, refer to.
const Library& library() {
  static const auto file = [](std::string name, std::string text) {
    return std::make_shared<const SourceFile>(name + ".joint", std::move(text));
  };
  static const Library all = {
      {"angle", file("angle",
                     "joint angle planar\n scalar phi [rad] = angle(a) - angle(b)\n"
                     " angular: angle(a) - angle(b) = phi\n coordinate angle = angle(a)\n")},
      {"line", file("line",
                    "joint line planar\n point pa on a\n point pb on b = pa\n unit t on b\n"
                    " let u = pa - pb\n line: dot(t, u) = 0\n coordinate slide = cross(u, t)\n")},
      {"prismatic", file("prismatic", "joint prismatic planar\n include line, angle\n")},
      {"circle", file("circle", "joint circle planar\n include circle as x, line as y\n")},
      {"twice", file("twice", "joint twice planar\n include prismatic as p, prismatic as q\n")}};
  return all;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool hand = data[0] == 'h';
  std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  const auto file = std::make_shared<const SourceFile>(hand ? "fuzz.hand" : "fuzz.joint", text);
  Library all = library();
  if (hand) {
    messages_about_hand(file, all.at("prismatic"), all);
    return 0;
  }
  all["fuzz"] = file;
  const ReadResult result = read_joint(file, all);
  render(*file, result.diagnostics);
  if (result.joint.has_value() == result.diagnostics.has_errors()) __builtin_trap();
  return 0;
}
