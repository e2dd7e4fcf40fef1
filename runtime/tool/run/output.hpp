// Output files; rows of a trajectory; saved states.
#pragma once

#include <string>

#include <cdot/snapshot.hpp>

#include "runtime/text/files.hpp"
#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

using text::OutputFile, text::write_file, text::summary_beside, text::read_file;

// time, then the state_columns() of every body by name: "rod.x"; then the sensors. Numbers read back to the same bits.
std::string csv_head(const Scene& scene);
std::string csv_row(const Scene& scene, const Frame& frame);

// The state of a run, from which another continues. Throws cdot::Error with the path if the file is not a state.
Snapshot read_state(const std::string& path);

}  // namespace cdot
