#include "derive/read.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "derive/elaborate.hpp"

namespace cdot::derive {

std::shared_ptr<const SourceFile> load_source(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path))
    throw std::runtime_error(path.string() + ": the file cannot be read");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  return std::make_shared<const SourceFile>(path.string(), std::move(text));
}

Library load_library(const std::filesystem::path& folder) {
  Library library;
  for (const auto& file : std::filesystem::directory_iterator(folder))
    if (file.path().extension() == ".joint")
      library.emplace(file.path().stem().string(), load_source(file.path()));
  return library;
}

ReadResult read_joint(std::shared_ptr<const SourceFile> file, const Library& library,
                      std::shared_ptr<Pool> pool, const ReadOptions& options) {
  ReadResult result;
  result.file = file;
  Source spec;
  spec.file = std::move(file);
  parse_source(spec);
  Elaborator elaborator(library, std::move(pool), options);
  elaborator.run(spec);
  elaborator.finish(result, spec);
  return result;
}

}  // namespace cdot::derive
