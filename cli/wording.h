#pragma once

#include <cstddef>
#include <string>

#include <meshgraft/core/error.h>

namespace meshgraft::cli {

/// Words a fact in the terms of the command line: flags and commands. Facts without words in cli/texts.json get
/// the text of the library.
FactText text_of(const Fact& fact);

/// Returns "location: problem. remedy", and after it the error's notes.
std::string sentence(const Error& error);

/// Returns "note. remedy".
std::string sentence(const Note& note);

/// Returns the location with the name of an option in place of its first `outer` parts. Fields and elements of
/// a document that follow them are left out, since the user gave no document. An empty `option` adds no part.
Location at_option(const Location& location, std::size_t outer, const std::string& option);

}  // namespace meshgraft::cli
