#include "tests/derive/language/reading.hpp"

#include <algorithm>

namespace cdot::derive {
namespace {

int scalar_rows(const Joint& joint, const std::vector<std::string>& names) {
  const auto asked = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  int count = 0;
  for (const Row& row : joint.rows)
    if (names.empty() || asked(row.name)) count += row.C->vector ? 2 : 1;
  for (const Coordinate& c : joint.coordinates)
    if (asked(c.name)) ++count;
  return count;
}

Matrix symbols(Pool& pool, const std::string& name, int rows, int columns) {
  Matrix m{rows, columns, {}};
  for (int i = 0; i < rows * columns; ++i)
    m.entries.push_back(pool.symbol(name + "." + std::to_string(i), Role::given));
  return m;
}

}  // namespace

GeneratedRows stand_in(const ReadResult& read) {
  return [&joint = *read.joint](const std::vector<std::string>& names) {
    Pool& pool = *joint.pool;
    const int rows = scalar_rows(joint, names);
    const int columns = 3 * static_cast<int>(joint.bodies.size());
    return Generated{symbols(pool, "C", rows, 1), symbols(pool, "Cdot", rows, 1), symbols(pool, "J", rows, columns),
                     symbols(pool, "K", rows, rows)};
  };
}

std::string messages_about_hand(const std::shared_ptr<const SourceFile>& hand,
                                const std::shared_ptr<const SourceFile>& joint, const Library& library) {
  HandFile file = read_hand(hand);
  const ReadResult plain = read_joint(joint, library);
  std::string out, about_formulas;
  for (const HandEntryAst& ast : file.entries) {
    const ReadResult read = read_anchored(plain, ast.anchors);
    if (!read.joint) return render(*read.file, read.diagnostics);
    const HandEntry entry = elaborate_entry(ast, file, read, stand_in(read), file.diagnostics);
    for (const Diagnostic& d : entry.remarks) about_formulas += render(*hand, d);
    for (const HandPart& part : entry.parts)
      for (const HandItem& item : part.items)
        if (!item.problem.empty())
          about_formulas += entry.id + ": " + item.text + "\n  no value: " + item.problem + "\n";
  }
  file.diagnostics.sort();
  return render(*hand, file.diagnostics) + about_formulas;
}

std::shared_ptr<const SourceFile> file_of(const std::filesystem::path& path) {
  return std::make_shared<const SourceFile>(path.filename().string(), load_source(path)->text);
}

Library library_of(const std::filesystem::path& folder) {
  Library library;
  for (const auto& [name, file] : load_library(folder))
    library[name] = std::make_shared<const SourceFile>(name + ".joint", file->text);
  return library;
}

}  // namespace cdot::derive
