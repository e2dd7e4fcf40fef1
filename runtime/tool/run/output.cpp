#include "runtime/tool/run/output.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unistd.h>

namespace cdot {

OutputFile::OutputFile(const std::string& path) : path_(path), temporary_(fmt::format("{}.{}.part", path, ::getpid())) {
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (!file_) fail("cannot be written");
}

OutputFile::~OutputFile() {
  if (!file_) return;
  std::fclose(file_);
  std::remove(temporary_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot be written");
}

void OutputFile::commit() {
  if (std::fflush(file_) != 0) fail("cannot be written");
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot take its name");
  std::fclose(file_);
  file_ = nullptr;
}

void OutputFile::fail(const char* what) const {
  throw Error(fmt::format("{}: {}: {}", path_, what, std::strerror(errno)));
}

void write_file(const std::string& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw Error(path + ": cannot be read");
  return text.str();
}

namespace {

std::vector<const char*> columns(const Scene& scene) {
  if (scene.dimension == Dimension::planar) return {"x", "y", "angle", "vx", "vy", "omega"};
  return {"x", "y", "z", "e0", "e1", "e2", "e3", "vx", "vy", "vz", "wx", "wy", "wz"};
}

}  // namespace

std::string csv_head(const Scene& scene) {
  std::string head = "time";
  for (const SceneBody& body : scene.bodies) {
    for (const char* column : columns(scene)) head += fmt::format(",{}.{}", body.name, column);
  }
  return head + "\n";
}

std::string csv_row(const Scene& scene, const Frame& frame) {
  const bool in_space = scene.dimension == Dimension::spatial;
  std::string row;
  auto out = fmt::format_to(std::back_inserter(row), "{}", frame.time);
  for (const BodyState& b : frame.bodies) {
    if (in_space)
      out = fmt::format_to(out, ",{},{},{},{},{},{},{},{},{},{},{},{},{}", b.x, b.y, b.z, b.e0, b.e1, b.e2, b.e3, b.vx,
                           b.vy, b.vz, b.wx, b.wy, b.wz);
    else out = fmt::format_to(out, ",{},{},{},{},{},{}", b.x, b.y, b.angle, b.vx, b.vy, b.w);
  }
  row += '\n';
  return row;
}

}  // namespace cdot
