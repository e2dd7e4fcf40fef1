// Results as bytes and back: what a process of the pool hands to the one that started it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cdot::derive {

// MessagePack, in which texts need not be UTF-8.
template <class T>
std::string packed(const T& value) {
  const auto bytes = nlohmann::json::to_msgpack(value);
  return {bytes.begin(), bytes.end()};
}
template <class T>
T unpacked(const std::string& bytes) {
  return nlohmann::json::from_msgpack(bytes).template get<T>();
}

}  // namespace cdot::derive
