// The command line as a function: what main gets, and the exit code that it returns.
#pragma once

namespace stillcut {

int run_stillcut(int argc, char** argv);  // `stillcut COMMAND ...`

}  // namespace stillcut
