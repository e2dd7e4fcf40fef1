// The playground as one HTML file: the page's parts, the engine, all specs, and scenes to begin with.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace cdot::play {

// `start` is the path of a scene or a spec, or empty. Throws std::runtime_error with the cause and the fix.
std::string playground_page(const std::string& start, const std::filesystem::path& specs,
                            const std::filesystem::path& engine);

// The same for a server on this machine: without an engine in WebAssembly the page asks the server.
std::string served_page(const std::string& start, const std::filesystem::path& specs,
                        const std::filesystem::path& engine);

// The example that the page begins with, as its files are now: {title, scene, specs}.
nlohmann::json first_example(const std::string& start, const std::filesystem::path& specs);

}  // namespace cdot::play
