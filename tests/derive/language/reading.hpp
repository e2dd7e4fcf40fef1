// Helpers of the reader's tests and its fuzzer: reading joints and hand derivations without a derivation.
#pragma once

#include <string>

#include "derive/language/hand/hand.hpp"
#include "derive/language/read.hpp"

namespace cdot::derive {

// Replaces Cdot's derivation by matrices of the right size with free symbols.
GeneratedRows stand_in(const ReadResult& read);

// All messages about a file of hand derivations, with remarks and formulas without a value, as text.
std::string messages_about_hand(const std::shared_ptr<const SourceFile>& hand,
                                const std::shared_ptr<const SourceFile>& joint, const Library& library);

// The specs of a folder, named without the folder, so messages do not depend on its path.
Library library_of(const std::filesystem::path& folder);
std::shared_ptr<const SourceFile> file_of(const std::filesystem::path& path);

}  // namespace cdot::derive
