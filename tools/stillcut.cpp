#include "tools/programs.hpp"

int main(int argc, char** argv) { return stillcut::run_stillcut(argc, argv); }
