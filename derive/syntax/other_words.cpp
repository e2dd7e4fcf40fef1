#include "derive/syntax/other_words.hpp"

#include <map>

namespace cdot::derive {
namespace {

constexpr std::string_view row = "a row is an equation by itself: pa = pb, or with a name: pin: pa = pb";
constexpr std::string_view always = "a row holds at all times; one that only bounds is an inequality: norm(u) <= l";
constexpr std::string_view on_coordinate =
    "it acts on a coordinate: write `coordinate NAME [rad] = ...`, and the rest in the scene";

// clang-format off
const std::map<std::string_view, std::string_view> meanings = {
    {"parameter", "scalar"}, {"param", "scalar"}, {"const", "scalar"}, {"constant", "scalar"}, {"number", "scalar"},
    {"real", "scalar"}, {"float", "scalar"}, {"double", "scalar"}, {"var", "scalar"}, {"variable", "scalar"},
    {"direction", "unit"}, {"normal", "unit"}, {"axis", "unit"}, {"vec", "vector"},
    {"def", "let"}, {"define", "let"}, {"set", "let"}, {"where", "let"},
    {"constraint", row}, {"equation", row}, {"row", row},
    {"if", always}, {"when", always}, {"while", always}, {"unless", always}, {"for", always},
    {"motor", on_coordinate}, {"limit", on_coordinate}, {"spring", on_coordinate}, {"damper", on_coordinate},
    {"friction", on_coordinate}};
// clang-format on

}  // namespace

std::string_view meaning_of(std::string_view word) {
  const auto found = meanings.find(word);
  return found == meanings.end() ? std::string_view() : found->second;
}

}  // namespace cdot::derive
