#pragma once

#include <string>

namespace meshgraft::platform {

/// Sets a variable of this process's environment. Returns false where it cannot.
bool set_environment_variable(const char* name, const std::string& value);

/// Replaces this process by a new run of its program, with the present environment and the arguments of `main`.
/// Returns where the system cannot do that.
void restart_program(char** arguments);

/// Shows `url` in the user's browser, if there is one. Prints nothing.
void open_in_browser(const std::string& url);

/// Makes a write to a closed pipe, or beyond the limit of a file's size, fail with an error; without it the
/// system may end the program.
void report_failed_writes();

}  // namespace meshgraft::platform
