#include "derive/pipeline/cache.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <link.h>
#include <unistd.h>
#include <vector>

#include "derive/pipeline/serialise.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

constexpr const char* extension = ".proof";

std::optional<std::string> content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(in), {}};
}

std::string digits(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

struct Kept {
  fs::file_time_type asked_for;
  std::uintmax_t bytes;
  fs::path path;
};

std::vector<Kept> all_in(const fs::path& folder) {
  std::vector<Kept> all;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() != extension) continue;
    std::error_code gone;  // another process may be at work here
    const Kept kept{entry.last_write_time(gone), entry.file_size(gone), entry.path()};
    if (!gone) all.push_back(kept);
  }
  return all;
}

}  // namespace

// FNV-1a
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

Memory::Memory(fs::path folder, std::uintmax_t most_bytes) : folder_(std::move(folder)), most_bytes_(most_bytes) {}

fs::path Memory::file_of(const std::string& key) const { return folder_ / (digits(hash_of(key)) + extension); }

std::optional<std::string> Memory::recall(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  const fs::path path = file_of(key);
  const std::optional<std::string> content = content_of(path);
  if (!content) return std::nullopt;
  try {
    Unpacking sealed(*content);
    const std::string seal = sealed.text(), body = sealed.text();
    if (seal != digits(hash_of(body))) return std::nullopt;
    Unpacking parts(body);
    if (parts.text() != key) return std::nullopt;
    std::error_code ignored;
    fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
    return parts.text();
  } catch (const Unpacking::Damaged&) {
    return std::nullopt;
  }
}

void Memory::keep(const std::string& key, const std::string& content) const {
  if (folder_.empty()) return;
  std::error_code failure;
  fs::create_directories(folder_, failure);
  const fs::path path = file_of(key);
  fs::path temporary = path;
  temporary += fmt::format(".{}", getpid());
  Parcel body, sealed;
  body.put(key);
  body.put(content);
  sealed.put(digits(hash_of(body.content())));
  sealed.put(body.content());
  {
    std::ofstream out(temporary, std::ios::binary);
    out << sealed.content();
    if (!out.flush()) fs::remove(temporary, failure);
  }
  fs::rename(temporary, path, failure);
}

void Memory::trim() const {
  if (folder_.empty()) return;
  std::vector<Kept> all = all_in(folder_);
  std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) { return a.asked_for > b.asked_for; });
  std::uintmax_t bytes = 0;
  for (const Kept& kept : all) {
    bytes += kept.bytes;
    std::error_code ignored;
    if (bytes > most_bytes_) fs::remove(kept.path, ignored);
  }
}

fs::path usual_memory() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value == nullptr ? "" : value);
  };
  if (const fs::path own = set("CDOT_CACHE"); !own.empty()) return own;
  if (const fs::path caches = set("XDG_CACHE_HOME"); !caches.empty()) return caches / "cdot";
  if (const fs::path home = set("HOME"); !home.empty()) return home / ".cache" / "cdot";
  return {};
}

std::string identity_of_program() {
  Parcel identity;
  const auto add = [](dl_phdr_info* loaded, std::size_t, void* to) {
    const std::string name = loaded->dlpi_name;
    if (name.starts_with("linux-")) return 0;  // the kernel's own page, which is no file
    const std::optional<std::string> content = content_of(name.empty() ? "/proc/self/exe" : name);
    if (!content) return 1;
    static_cast<Parcel*>(to)->put(digits(hash_of(*content)));
    return 0;
  };
  return dl_iterate_phdr(add, &identity) == 0 ? identity.content() : "";
}

}  // namespace cdot::derive
