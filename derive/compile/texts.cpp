#include "derive/compile/texts.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <sstream>
#include <string_view>
#include <utility>

#include "derive/compile/arithmetic.hpp"
#include "derive/compile/space.hpp"
#include "derive/program/print.hpp"

namespace cdot::compile {
namespace {

bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; }

constexpr const char* head = R"(// {}: a step of {}, written by
//   {}
// Do not edit. T is float, double, or a pack of them (cdot/pack.hpp): each lane is a mechanism of its own. It has
// the bits that it has alone if the compiler contracts nothing: -ffp-contract=off, and -fno-tree-slp-vectorize
// where GCC 12 may use fused operations. No heap, no exceptions.
)";

// The name `i` as that place.
std::string at_place(const std::string& text, const std::string& place) {
  std::string placed;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool is_i = text[at] == 'i' && at > 0 && !is_of_name(text[at - 1]) && !is_of_name(text[at + 1]);
    placed += is_i ? place : text.substr(at, 1);
  }
  return placed;
}

}  // namespace

std::string head_of(const Mechanism& mechanism, const std::string& command, bool with_cmath) {
  std::string text = fmt::format(head, mechanism.title, mechanism.method_name, command);
  for (const std::string& note : mechanism.notes) text += "// " + note + "\n";
  text += std::string("#pragma once\n\n") + (with_cmath ? "#include <cmath>\n\n" : "") + arithmetic;
  return mechanism.spatial() ? text + space : text;
}

std::string unrolled(const std::string& text, const Counts& counts) {
  const struct {
    std::string head;
    std::size_t count, few;
  } loops[] = {{"for (int i = 0; i < bodies; ++i) ", counts.bodies, 16},
               {"for (int i = 0; i < rows; ++i) ", counts.rows, 16},
               {"for (int i = 0; i < Slope::size; ++i) ", counts.rates, few_rates},
               {"for (int i = 0; i < Slope::centres; ++i) ", counts.centres, few_rates},
               {"for (int i = 0; i < angles_kept; ++i) ", counts.angles, 16}};
  std::string lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    std::string here = line + "\n";
    for (const auto& [head, count, few] : loops) {
      const std::size_t at = line.find(head);
      if (at == std::string::npos || line.find_first_not_of(' ') != at || count > few) continue;
      here.clear();
      for (std::size_t i = 0; i < count; ++i)
        here += at_place(line.substr(0, at) + line.substr(at + head.size()), std::to_string(i)) + "\n";
    }
    lines += here;
  }
  return lines;
}

std::string with_arguments(std::string text, const Arguments& given) {
  const auto& [inputs, angles, events, bonds, turns, poses] = given;
  const std::pair<std::string_view, std::string> marks[] = {
      {"$C", angles ? "    Angles next_angles;\n    count($ss.q, s.time, next_angles.angle, next_angles.turns);\n    "
                      "s.angles = next_angles;\n"
                    : ""},
      {"$d", std::string(inputs ? "const Inputs& p, " : "") + (angles ? "const Angles& angles, " : "") +
                 (events ? "const Events& events, " : "") + (bonds ? "const Bonds& bonds, " : "")},
      {"$s", std::string(inputs ? "s.p, " : "") + (angles ? "s.angles, " : "") + (events ? "s.events, " : "") +
                 (bonds ? "s.bonds, " : "")},
      {"$p", std::string(inputs ? "p, " : "") + (angles ? "angles, " : "") + (events ? "events, " : "") +
                 (bonds ? "bonds, " : "")},
      {"$g", poses},
      {"$q", turns ? "s.q, " : ""},
      {"$t", turns ? "q, " : ""},
      {"$w", turns ? "    weigh(at.q);\n" : ""},
      {"$W", turns ? "    weigh(s.q);\n" : ""}};
  for (const auto& [mark, argument] : marks)
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos;) text.replace(at, mark.size(), argument);
  return text;
}

bool reads(const std::string& arguments, const std::string& argument) {
  const std::size_t array = arguments.find("(&" + argument + ")");
  if (array == std::string::npos) {
    const auto has = [&](const std::string& text) { return arguments.find(text) != std::string::npos; };
    return has("& " + argument + ",") || has("* " + argument + ",") || arguments.ends_with("& " + argument + ")");
  }
  const std::string before = arguments.substr(0, array);
  return before.find("const", before.rfind(',') + 1) != std::string::npos;
}

std::string by_fours(const std::vector<Named>& things, const std::string& four, const std::string& one) {
  const auto lines = [&](std::size_t begin, std::size_t end, std::size_t width) {
    std::string text;
    for (std::size_t i = begin; i < end; i += width) {
      const auto at = [&](std::size_t k) { return things[std::min(i + k, end - 1)]; };
      const std::string line =
          width == 1
              ? fmt::format(fmt::runtime(one), at(0).name, at(0).number)
              : fmt::format(fmt::runtime(four), at(0).name, at(1).name, at(2).name, at(3).name,
                            fmt::format("{}, {}, {}, {}", at(0).name, at(1).name, at(2).name, at(3).name),
                            fmt::format("{}, {}, {}, {}", at(0).number, at(1).number, at(2).number, at(3).number));
      for (const std::string& wrapped : derive::wrapped("      " + line + ";")) text += wrapped + "\n";
    }
    return text;
  };
  const std::size_t count = things.size(), wide = count % 4 < 3 ? count - count % 4 : count;
  if (wide == 0) return lines(0, count, 1);
  return "    if constexpr (WideOf<T>::exists) {\n" + lines(0, wide, 4) + lines(wide, count, 1) + "    } else {\n" +
         lines(0, count, 1) + "    }\n";
}

}  // namespace cdot::compile
