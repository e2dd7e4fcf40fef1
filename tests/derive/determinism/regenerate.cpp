// Writes the kernels of the given specs without proofs, for the repetitions of the determinism test. usage: regenerate
// SPECS_FOLDER OUTPUT SPEC...
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "derive/kernel/generate.hpp"
#include "derive/language/specs_folder.hpp"

int main(int argc, char** argv) {
  using namespace cdot::derive;
  const SpecsFolder folder(argv[1]);
  std::vector<GeneratedJoint> joints;
  for (int i = 3; i < argc; ++i) {
    const ReadResult read = folder.read(argv[i]);
    if (!read.joint) return 2;
    const Derivation derivation = derive(*read.joint);
    joints.push_back(print(simplified(plan(derivation))));
  }
  for (const auto& [name, content] : collect(joints, {})) {
    const std::filesystem::path path = std::filesystem::path(argv[2]) / name;
    std::filesystem::create_directories(path.parent_path());
    if (!(std::ofstream(path, std::ios::binary) << content).flush()) return 2;
  }
  return 0;
}
