// Headers that most files of this project include, compiled once for all files of a library. Each file includes what it
// needs nevertheless: the preset `clang` builds without this one.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>
