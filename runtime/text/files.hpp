// Files, which appear whole or not at all.
#pragma once

#include <cstdio>
#include <initializer_list>
#include <string>
#include <string_view>

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
// them do.
std::FILE* summary_beside(std::initializer_list<std::string_view> outputs);
std::string read_file(const std::string& path);

}  // namespace cdot::text
