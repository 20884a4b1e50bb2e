// The programs as functions: what main gets, and the exit code that it returns.
#pragma once

namespace stillcut {

int run_stillcut(int argc, char** argv);   // `stillcut COMMAND ...`
int run_stillcutd(int argc, char** argv);  // the daemon

}  // namespace stillcut
