// The engine as one function of a WebAssembly module. The answer stays valid until the next call.
#include <string>

#include "derive/play/engine.hpp"

extern "C" const char* cdot_ask(const char* request) {
  static cdot::play::Engine engine;
  static std::string answer;
  answer = engine.ask(request);
  return answer.c_str();
}
