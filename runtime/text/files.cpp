#include "runtime/text/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <unistd.h>
#include <utility>

namespace cdot::text {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view standard_output = "-";

// The regular file that is to take the place of `path`: a link's target. Empty for a device, a pipe or a link to one,
// whose place nothing may take.
std::string replaceable(const std::string& path) {
  std::error_code none;
  const bool link = fs::is_symlink(path, none), exists = fs::exists(path, none);
  if (link ? !fs::is_regular_file(path, none) : exists && !fs::is_regular_file(path, none)) return {};
  return link ? fs::canonical(path).string() : path;
}

}  // namespace

OutputFile::OutputFile(const std::string& path) : path_(path) {
  if (path == standard_output) {
    path_ = "standard output";
    file_ = stdout;
    return;
  }
  final_ = replaceable(path);
  if (!final_.empty()) temporary_ = fmt::format("{}.{}.part", final_, ::getpid());
  file_ = std::fopen(final_.empty() ? path.c_str() : temporary_.c_str(), "wb");
  if (!file_) fail("cannot be written");
}

OutputFile::~OutputFile() {
  if (file_ && file_ != stdout) std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot be written");
}

void OutputFile::commit() {
  // Some disks say only now that they are full.
  const bool flushed = std::fflush(file_) == 0;
  if (file_ == stdout && flushed) return;
  if (std::fclose(std::exchange(file_, nullptr)) != 0 || !flushed) fail("cannot be written");
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), final_.c_str()) != 0) fail("cannot take its name");
  temporary_.clear();
}

void OutputFile::fail(const char* what) const {
  throw std::runtime_error(fmt::format("{}: {}: {}", path_, what, std::strerror(errno)));
}

void write_file(const std::string& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::FILE* summary_beside(std::initializer_list<std::string_view> outputs) {
  std::set<fs::path> files;
  for (const std::string_view output : outputs)
    if (const std::string file = output == standard_output ? "" : replaceable(std::string(output));
        !file.empty() && !files.insert(fs::weakly_canonical(file)).second)
      throw std::runtime_error(
          fmt::format("{}: two outputs cannot share one file. Likely fix: another name for one of them", output));
  const auto taken = std::count(outputs.begin(), outputs.end(), standard_output);
  if (taken > 1)
    throw std::runtime_error(
        fmt::format("{} outputs cannot share standard output. Likely fix: name a file for all but one", taken));
  return taken == 1 ? stderr : stdout;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return text.str();
}

std::vector<fs::path> files_in(const fs::path& folder, std::initializer_list<std::string_view> endings) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
    if (std::ranges::find(endings, entry.path().extension().string()) != endings.end() && entry.is_regular_file(none))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace cdot::text
