#include "derive/play/page.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "derive/language/read.hpp"
#include "derive/play/assets.hpp"
#include "derive/play/first_sight.hpp"
#include "derive/play/trial.hpp"
#include "runtime/tool/run/output.hpp"

namespace cdot::play {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// By the paths that the engine reads them under.
json all_specs(const fs::path& specs) {
  json files = json::object();
  for (const char* space : {"planar", "spatial", "coordinate"})
    for (const fs::path& file : text::files_in(specs / space, {".joint", ".effect", ".hand"}))
      files[fmt::format("specs/{}/{}", space, file.filename().string())] = read_file(file.string());
  if (files.empty())
    throw std::runtime_error(
        fmt::format("no specs in {}. Fix: run from the folder that holds specs/, or say --specs DIR", specs.string()));
  return files;
}

// The value of a key at the top of a scene, without quotes; empty if it has none. A scene with mistakes has a title
// too.
std::string value_of(const char* key, const std::string& scene) {
  std::smatch found;
  const std::regex assignment(fmt::format("(^|\\n) *{} *= *\"?([^\"\\n#]*)", key));
  return std::regex_search(scene, found, assignment) ? found[2].str() : "";
}

// A scene, or a first one for a spec, with the specs beside it that it names.
json example(const fs::path& file) {
  const std::string scene = derive::is_spec(file) ? trial_scene(file.string()) : read_file(file.string());
  const std::string title = value_of("title", scene);
  const char* const space = value_of("dimension", scene).starts_with('3') ? "spatial" : "planar";
  json specs = json::object();
  const fs::path folder = file.parent_path().empty() ? "." : file.parent_path();
  for (const fs::path& spec : text::files_in(folder, {".joint", ".effect", ".hand"}))
    if (scene.find(spec.stem().string()) != scene.npos)
      specs[fmt::format("specs/{}/{}", space, spec.filename().string())] = read_file(spec.string());
  return {{"title", title.empty() ? file.stem().string() : title}, {"scene", scene}, {"specs", specs}};
}

// To begin a spec of one's own with.
json blank(const fs::path& spec) {
  std::smatch header;
  const std::string text = read_file(spec.string());
  std::regex_search(text, header, std::regex("(joint|effect) \\w+ (planar|spatial|coordinate)"));
  json begun = example(spec);
  begun["title"] = fmt::format("new {}, {}", header[1].str(),
                               header[2] == "coordinate" ? "on a coordinate"
                               : header[2] == "spatial"  ? "in space"
                                                         : "in the plane");
  return begun;
}

constexpr std::size_t longest_scene = 40000;  // bytes of an example

// The page opens with the scene asked for, or with one that has much to see.
fs::path first_file(const std::string& start, const fs::path& specs) {
  return start.empty() ? specs / "scenes" / "machine.toml" : fs::path(start);
}

json gallery(const std::string& start, const fs::path& specs) {
  const fs::path first = first_file(start, specs);
  json all = json::array({example(first)});
  for (const fs::path& spec : text::files_in(specs / "scenes" / "new", {".joint", ".effect"}))
    all.push_back(blank(spec));
  for (const char* folder : {"scenes/gallery", "scenes", "scenes/spatial"})
    for (const fs::path& scene : text::files_in(specs / folder, {".toml"}))
      if (fs::file_size(scene) < longest_scene && !fs::equivalent(scene, first)) all.push_back(example(scene));
  return all;
}

std::string in_base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u;
    };
    const unsigned bits = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (unsigned k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

// "</script>" would end the element.
std::string in_a_script(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != text.npos;) text.replace(at, 2, "<\\/");
  return text;
}

std::string filled(std::string_view page, const std::vector<std::pair<std::string, std::string>>& values) {
  std::string result;
  while (!page.empty()) {
    const std::size_t open = std::min(page.find("{{"), page.size());
    result += page.substr(0, open);
    page.remove_prefix(open);
    if (page.empty()) break;
    const std::size_t close = page.find("}}");
    for (const auto& [key, value] : values)
      if (key == page.substr(2, close - 2)) result += value;
    page.remove_prefix(close + 2);
  }
  return result;
}

}  // namespace

json first_example(const std::string& start, const fs::path& specs) { return example(first_file(start, specs)); }

namespace {

bool has_engine(const fs::path& engine) {
  return fs::exists(engine / "engine.js") && fs::exists(engine / "engine.wasm");
}

std::string page_of(const std::string& start, const fs::path& specs, const std::string& glue, const std::string& wasm) {
  std::string script;
  for (int k = 0; k < script_count; ++k) script += scripts[k];
  const json files = all_specs(specs), scenes = gallery(start, specs);
  const json data = {
      {"files", files}, {"gallery", scenes}, {"first", first_sight(files, scenes[0])}, {"served", wasm.empty()}};
  return filled(page_html, {{"style", std::string(page_css)},
                            {"glue", in_a_script(glue)},
                            {"worker", std::string(worker_js)},
                            {"wasm", in_base64(wasm)},
                            {"data", in_a_script(data.dump())},
                            {"script", script}});
}

}  // namespace

std::string playground_page(const std::string& start, const fs::path& specs, const fs::path& engine) {
  if (!has_engine(engine))
    throw std::runtime_error(
        fmt::format("there is no engine in {}. Fix: without -o the page needs none; or install emscripten and build "
                    "the target playground: cmake --build build/dev --target playground",
                    engine.string()));
  return page_of(start, specs, read_file((engine / "engine.js").string()),
                 read_file((engine / "engine.wasm").string()));
}

std::string served_page(const std::string& start, const fs::path& specs, const fs::path& engine) {
  return has_engine(engine) ? playground_page(start, specs, engine) : page_of(start, specs, "", "");
}

}  // namespace cdot::play
