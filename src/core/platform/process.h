#pragma once

#include <stop_token>
#include <string>

namespace meshgraft::platform {

/// Sets a variable of this process's environment. Returns false on failure.
bool set_environment_variable(const char* name, const std::string& value);

/// Replaces this process by a new run of its program, with the current environment and the arguments of
/// `main`. Returns only if the system cannot do that.
void restart_program(char** arguments);

/// Opens a web page, a URL or a file, in the user's browser, if there is one. Prints nothing. Everybody on the
/// machine may read what is passed.
void open_in_browser(const std::string& page);

/// Waits until nothing can write to this process's standard input any more, as when the program that started it
/// ends. Returns false where a stop was requested before.
bool wait_for_closed_input(const std::stop_token& stop);

/// Makes a write to a closed pipe, or beyond the file size limit, fail with an error. By default the system
/// may end the program.
void report_failed_writes();

}  // namespace meshgraft::platform
