#pragma once

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

}  // namespace meshgraft::cli
