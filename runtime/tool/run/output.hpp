// Files that appear whole or not at all, and the rows of a trajectory.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include <cdot/snapshot.hpp>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// Writes beside the path and takes its name when all is there. Throws cdot::Error when the disk
// does not obey.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  ~OutputFile();  // without commit() nothing is left behind
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

void write_file(const std::string& path, std::string_view text);
std::string read_file(const std::string& path);

// time, then of every body by name x, y, angle, vx, vy, omega: "rod.x"; in space x, y, z, e0 to e3,
// vx, vy, vz, wx, wy, wz. Numbers read back to the same bits.
std::string csv_head(const Scene& scene);
std::string csv_row(const Scene& scene, const Frame& frame);

// The state of a run, which another goes on from. Throws cdot::Error with the path if the file is no state.
Snapshot read_state(const std::string& path);

}  // namespace cdot
