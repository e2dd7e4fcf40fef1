// The playground's engine: requests as JSON in, answers as JSON out. Compiled to WebAssembly it runs in the page;
// compiled for the machine it runs in the tests. Specs and scenes are files of its current directory.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace cdot::play {

class LiveScene;

// The requests, by their member `do`:
//   write    files {path: text}                       writes them below the current directory
//   check    path                                     messages of the reader of specs
//   explain  path                                     the derivation as HTML; every name carries data-name
//   kernel   path                                     its C++ as HTML, with the same names
//   judge    path                                     verdicts on a .hand file beside its spec
//   hand     path                                     of a spec: the text of an entry to begin with
//   load     path, method, rate, measure              reads a scene and makes its World; describes it
//   change   gravity, method, rate, measure           goes on from the present state with other settings
//   step     time                                     moves on by about `time` [s]; the state
//   drag     body, local, target                      a damped spring from the pointer to a point of the body
//   drop                                              removes it
//   motor    joint, effect, speed, max                changes a motor
//   set      joint, name, numbers                     changes a parameter of a joint
//   marks    joint                                    the names of a joint's spec as points and arrows, at present
// An answer has `problems` if the request failed: text for people.
class Engine {
 public:
  Engine();
  ~Engine();
  // Never throws.
  std::string ask(const std::string& request);

 private:
  nlohmann::json answer(const nlohmann::json& request);
  std::unique_ptr<LiveScene> live_;
};

}  // namespace cdot::play
