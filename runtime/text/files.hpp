// Files, which appear whole or not at all.
#pragma once

#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace cdot::text {

// Writes a temporary file and renames it when it is complete; writes to a device or a pipe directly. "-" is standard
// output. Throws std::runtime_error if the disk refuses.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();  // removes the file unless commit() was called
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::string path_, final_, temporary_;  // as asked for; the file to be; the file until then. Else empty
  std::FILE* file_ = nullptr;
};

void write_file(const std::string& path, std::string_view text);
// Where the summary goes: to standard output, unless one of the outputs takes that. Throws std::runtime_error if two of
// them do, or name one file.
std::FILE* summary_beside(std::initializer_list<std::string_view> outputs);
std::string read_file(const std::string& path);
// The files of a folder with these endings, sorted; none if it cannot be read. A link that leads nowhere, as the lock
// that an editor writes beside a file, is none of them.
std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder,
                                            std::initializer_list<std::string_view> endings);

}  // namespace cdot::text
