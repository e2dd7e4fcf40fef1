// What was found out before, in files: a folder that other processes may write to at the same time, and that may be
// deleted, damaged or unusable at any time without harm.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace cdot::derive {

class Memory {
 public:
  // An empty folder: remembers nothing.
  explicit Memory(std::filesystem::path folder, std::uintmax_t most_bytes = std::uintmax_t{64} << 20);

  // What was kept under this very key; the whole key is compared.
  std::optional<std::string> recall(const std::string& key) const;
  // Through a temporary file, so that nobody ever reads half of one. Nothing happens if that cannot be.
  void keep(const std::string& key, const std::string& content) const;
  // Forgets what was not asked for longest, until the rest takes no more than `most_bytes`.
  void trim() const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path folder_;
  std::uintmax_t most_bytes_;
};

// $CDOT_CACHE, else $XDG_CACHE_HOME/cdot, else ~/.cache/cdot; empty if there is none of these.
std::filesystem::path usual_memory();

// Of this program: of its file and of all libraries that it loaded. Empty if one of them cannot be read.
std::string identity_of_program();

std::uint64_t hash_of(std::string_view text);

}  // namespace cdot::derive
