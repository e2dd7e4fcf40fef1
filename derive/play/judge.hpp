// Hand derivations, judged as a person types them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cdot::play {

// The verdicts on a .hand file beside its spec: {messages, agree, differ}. A message has the severity "agrees", or that
// of a mistake; its place is that of the formula.
nlohmann::json judge_hand(const std::string& hand);
// {text}: an entry to begin with, J of zeros or, of an effect, no force.
nlohmann::json first_entry(const std::string& spec);

}  // namespace cdot::play
