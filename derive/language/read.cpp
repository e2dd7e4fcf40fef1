#include "derive/language/read.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>

#include "derive/language/elaborate.hpp"
#include "derive/syntax/parser.hpp"
#include "runtime/text/files.hpp"

namespace cdot::derive {
namespace {

bool has_body(const Joint& joint, const std::string& body) {
  return body == "world" || std::find(joint.bodies.begin(), joint.bodies.end(), body) != joint.bodies.end();
}

ReadResult read(std::shared_ptr<const SourceFile> file, const Library& library, const Anchors& anchors) {
  ReadResult result;
  result.file = file;
  result.library = library;
  Source spec;
  spec.file = std::move(file);
  parse_source(spec);
  Elaborator elaborator(library, spec.ast.dimension == "spatial" ? 3 : 2, anchors);
  elaborator.run(spec);
  elaborator.finish(result, spec);
  return result;
}

}  // namespace

std::shared_ptr<const SourceFile> load_source(const std::filesystem::path& path) {
  if (path == standard_input)
    return std::make_shared<const SourceFile>("<stdin>", std::string(std::istreambuf_iterator<char>(std::cin), {}));
  std::ifstream in(path, std::ios::binary);
  if (std::error_code none; std::filesystem::is_directory(path, none))
    throw std::runtime_error(path.string() + ": this is a folder, not a spec");
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::string text{std::istreambuf_iterator<char>(in), {}};
  return std::make_shared<const SourceFile>(path.string(), std::move(text));
}

bool is_spec(const std::filesystem::path& file) {
  return file.extension() == ".joint" || file.extension() == ".effect";
}

Library load_library(const std::filesystem::path& folder) {
  Library library;
  for (const std::filesystem::path& spec : text::files_in(folder.empty() ? "." : folder, {".joint"}))
    library.emplace(spec.stem().string(), load_source(spec));
  return library;
}

int dimension_of(const SourceFile& file) {
  Diagnostics unheard;
  const Tokens tokens = lex(file, false, unheard);
  if (!tokens.readable) return 2;
  return parse_joint(file, tokens, unheard).dimension == "spatial" ? 3 : 2;
}

ReadResult read_joint(std::shared_ptr<const SourceFile> file, const Library& library) {
  return read(std::move(file), library, {});
}

ReadResult read_anchored(const ReadResult& plain, const Anchors& anchors) {
  Anchors possible;  // the caller reports an anchor on a body that the joint lacks
  for (const auto& [name, body] : anchors)
    if (plain.joint && has_body(*plain.joint, body)) possible.emplace(name, body);
  return read(plain.file, plain.library, possible);
}

}  // namespace cdot::derive
